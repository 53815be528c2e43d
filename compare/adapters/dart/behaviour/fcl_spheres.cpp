/* FCL's spheres are polyhedra of 58 corners within the sphere: by default all shapes are triangles
 * (the constructor of ConstraintSolver, 6.12.1; dartsim/dart issue 59).
 * g++ -std=c++17 -I/usr/include/eigen3 fcl_spheres.cpp -ldart */
#include <dart/collision/CollisionDetector.hpp>
#include <dart/collision/CollisionGroup.hpp>
#include <dart/dynamics/SimpleFrame.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <iostream>
int main()
{
    const Eigen::Vector3d along = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
    auto detector = dart::collision::CollisionDetector::getFactory()->create("fcl");
    dart::dynamics::SimpleFrame a, b;
    a.setShape(std::make_shared<dart::dynamics::SphereShape>(0.5));
    b.setShape(a.getShape());
    auto group = detector->createCollisionGroup(&a, &b);
    for (double depth : {0.001, 0.02, 0.05, 0.1, 0.2}) {
        b.setTranslation((1 - depth) * along);
        dart::collision::CollisionResult result;
        group->collide(dart::collision::CollisionOption(true, 1000), &result);
        std::cout << "expected 1 contact, depth " << depth << "; found " << result.getNumContacts();
        double deepest = 0, off = 0;
        for (const auto &c : result.getContacts()) {
            const double cosine = std::min(1.0, std::abs(c.normal.normalized().dot(along)));
            deepest = std::max(deepest, c.penetrationDepth);
            off = std::max(off, 57.3 * std::acos(cosine));
        }
        std::cout << ", depth " << deepest << ", normals up to " << off << " degrees off\n";
    }
}
