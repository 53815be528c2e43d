/* FCLCollisionDetector puts a sphere of 0.1 m in the place of a capsule, and a sheet across the y
 * axis in that of a plane; DARTCollisionDetector finds no contact of a cylinder (6.12.1, which says
 * so on the terminal).
 * g++ -std=c++17 -I/usr/include/eigen3 missing_shapes.cpp -ldart */
#include <dart/collision/CollisionDetector.hpp>
#include <dart/collision/CollisionGroup.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/CapsuleShape.hpp>
#include <dart/dynamics/CylinderShape.hpp>
#include <dart/dynamics/PlaneShape.hpp>
#include <dart/dynamics/SimpleFrame.hpp>
#include <iostream>
static void touch(const char *name, dart::dynamics::ShapePtr low, dart::dynamics::ShapePtr high)
{
    dart::dynamics::SimpleFrame a, b;
    a.setShape(low);
    b.setShape(high);
    b.setTranslation(Eigen::Vector3d(0.1, 3, 0.9)); /* 0.1 m deep or more */
    dart::collision::CollisionResult found;
    auto detector = dart::collision::CollisionDetector::getFactory()->create(name);
    detector->createCollisionGroup(&a, &b)->collide({true, 1000}, &found);
    std::cout << high->getType() << " in " << low->getType() << ": expected contacts, found "
              << found.getNumContacts() << "\n";
}
int main()
{
    using namespace dart::dynamics;
    auto slab = std::make_shared<BoxShape>(Eigen::Vector3d(4, 8, 1));
    touch("fcl", slab, std::make_shared<CapsuleShape>(0.2, 0.6));
    auto plane = std::make_shared<PlaneShape>(Eigen::Vector3d::UnitZ(), 0.5);
    touch("fcl", plane, std::make_shared<BoxShape>(Eigen::Vector3d::Ones()));
    touch("dart", slab, std::make_shared<CylinderShape>(0.3, 1));
}
