/* PGS as shipped, 30 sweeps, has not converged where ten spheres stand on each other, 0.1 mm deep:
 * each contact should part at 0.001 m/s, so the top sphere should rise at 0.01 m/s.
 * g++ -std=c++17 -I/usr/include/eigen3 pgs_iterations.cpp -ldart */
#include <dart/collision/CollisionDetector.hpp>
#include <dart/constraint/BoxedLcpConstraintSolver.hpp>
#include <dart/constraint/PgsBoxedLcpSolver.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/simulation/World.hpp>
#include <iostream>
using namespace dart;
int main()
{
    for (int sweeps : {30, 300, 3000}) {
        auto world = simulation::World::create();
        auto pgs = std::make_shared<constraint::PgsBoxedLcpSolver>();
        pgs->setOption({sweeps, 0, 0});
        auto solver = std::make_unique<constraint::BoxedLcpConstraintSolver>(pgs, nullptr);
        solver->setCollisionDetector(collision::CollisionDetector::getFactory()->create("dart"));
        world->setConstraintSolver(std::move(solver));
        for (int i = 0; i < 11; ++i) { /* the lowest is held */
            auto ball = dynamics::Skeleton::create("ball " + std::to_string(i));
            auto [joint, body] = ball->createJointAndBodyNodePair<dynamics::FreeJoint>();
            body->createShapeNodeWith<dynamics::CollisionAspect, dynamics::DynamicsAspect>(
                std::make_shared<dynamics::SphereShape>(0.5));
            joint->setPosition(5, 0.9999 * i);
            ball->setMobile(i > 0);
            world->addSkeleton(ball);
        }
        world->step();
        std::cout << sweeps << " sweeps: expected 0.01 m/s, found "
                  << world->getSkeleton(10)->getVelocity(5) << " m/s\n";
    }
}
