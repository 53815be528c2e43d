/* Slow impacts do not bounce: a rebound slower than 0.1 m/s is none, and that number cannot be set
 * (DART_BOUNCING_VELOCITY_THRESHOLD in ContactConstraint.cpp, 6.12.1; dartsim/dart issue 372).
 * g++ -std=c++17 -I/usr/include/eigen3 restitution_threshold.cpp -ldart */
#include <dart/collision/CollisionDetector.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/simulation/World.hpp>
#include <iostream>
using namespace dart;
int main()
{
    for (double speed : {2.0, 0.3, 0.21, 0.19, 0.05}) {
        auto world = simulation::World::create();
        world->getConstraintSolver()->setCollisionDetector(
            collision::CollisionDetector::getFactory()->create("dart"));
        world->setGravity(Eigen::Vector3d::Zero());
        for (int i = 0; i < 2; ++i) {
            auto ball = dynamics::Skeleton::create("ball " + std::to_string(i));
            auto [joint, body] = ball->createJointAndBodyNodePair<dynamics::FreeJoint>();
            auto *node =
                body->createShapeNodeWith<dynamics::CollisionAspect, dynamics::DynamicsAspect>(
                    std::make_shared<dynamics::SphereShape>(0.5));
            node->getDynamicsAspect()->setRestitutionCoeff(i == 0 ? 1 : 0.5);
            joint->setPosition(5, 0.9999 * i);
            joint->setVelocity(5, -speed * i);
            world->addSkeleton(ball);
        }
        world->step();
        auto v = [&](int i) { return world->getSkeleton(i)->getVelocity(5); };
        std::cout << speed << " m/s: expected " << speed / 2 << ", found " << v(1) - v(0) << "\n";
    }
}
