/* FCL's contacts of a cube that is tilted by 0.01 and stands in a slab with one edge, 0.1 mm deep.
 * By default all shapes are triangles (the constructor of ConstraintSolver, 6.12.1), and contacts on
 * the line where the surfaces cross, whose depth is 0, have the depth of the edge.
 * g++ -std=c++17 -I/usr/include/eigen3 fcl_box.cpp -ldart */
#include <dart/collision/CollisionDetector.hpp>
#include <dart/collision/CollisionGroup.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/SimpleFrame.hpp>
#include <iostream>
int main()
{
    auto detector = dart::collision::CollisionDetector::getFactory()->create("fcl");
    dart::dynamics::SimpleFrame slab, cube;
    slab.setShape(std::make_shared<dart::dynamics::BoxShape>(Eigen::Vector3d(6, 6, 6)));
    cube.setShape(std::make_shared<dart::dynamics::BoxShape>(Eigen::Vector3d(1, 1, 1)));
    slab.setTranslation(Eigen::Vector3d(0.2, 0.1, -3));
    cube.setRotation(Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitY()).toRotationMatrix());
    cube.setTranslation(Eigen::Vector3d(0, 0, 0.5 * (std::sin(0.01) + std::cos(0.01)) - 1e-4));
    dart::collision::CollisionResult found;
    detector->createCollisionGroup(&slab, &cube)->collide({true, 1000}, &found);
    std::cout << "expected depth 0.0001 at x = 0.495 and 0 at x = 0.485; contacts found: "
              << found.getNumContacts() << "\n";
    for (const auto &c : found.getContacts()) {
        std::cout << "at " << c.point.transpose() << ": depth " << c.penetrationDepth << "\n";
    }
}
