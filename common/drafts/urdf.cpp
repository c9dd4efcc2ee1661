// URDF: a tree of links, each placed by the joint to its parent.
#include <algorithm>
#include <set>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/drafts/robot.hpp"
#include "common/drafts/xml.hpp"

namespace fathom::drafts {
namespace {

struct Placed {
  Joint joint;
  Eigen::Isometry3d X_PJ{Eigen::Isometry3d::Identity()};  ///< joint (and child, at zero) in its parent
  Eigen::Vector3d axis_J{Eigen::Vector3d::UnitX()};
};

Eigen::Vector3d triple(const Element& element, const char* name, const Eigen::Vector3d& otherwise) {
  if (!element.has(name)) return otherwise;
  const auto v = element.numbers(element.attribute(name), 3);
  return {v[0], v[1], v[2]};
}

Eigen::Isometry3d origin_of(const Element& element) {
  const Element origin = element.child("origin");
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = triple(origin, "xyz", Eigen::Vector3d::Zero());
  X.linear() = rotation_from_euler(triple(origin, "rpy", Eigen::Vector3d::Zero()));
  return X;
}

Placed read_joint(const Element& element) {
  Placed placed{.joint = {.name = element.attribute("name"),
                          .type = element.attribute("type"),
                          .parent = element.child("parent").attribute("link"),
                          .child = element.child("child").attribute("link")},
                .X_PJ = origin_of(element),
                .axis_J = triple(element.child("axis"), "xyz", Eigen::Vector3d::UnitX())};
  if (placed.joint.parent.empty() || placed.joint.child.empty()) element.fail("a joint without parent or child");
  if (placed.axis_J.norm() < 1e-6) element.fail("an axis of length zero");
  return placed;
}

// In the link's axes; turned to the model's when its place is known.
Link read_link(const Element& element) {
  Link link{.name = element.attribute("name")};
  const Element inertial = element.child("inertial");
  if (inertial.none() || !inertial.child("mass").has("value")) return link;
  link.mass = inertial.number(inertial.child("mass").attribute("value"));
  if (link.mass < 0.0) inertial.fail("a mass below zero");
  const Eigen::Isometry3d X_LI = origin_of(inertial);
  link.com_M = X_LI.translation();
  link.inertia_M = X_LI.linear() * inertia_of(inertial.child("inertia"), true) * X_LI.linear().transpose();
  return link;
}

void place(Link& link, const Eigen::Isometry3d& X_ML) {
  link.X_ML = X_ML;
  link.com_M = X_ML * link.com_M;
  link.inertia_M = X_ML.linear() * link.inertia_M * X_ML.linear().transpose();
}

}  // namespace

Robot read_urdf(const std::string& path) {
  const XmlFile file{path};
  const Element root = file.root();
  if (root.tag() != "robot")
    root.fail("is no URDF (it begins with <" + root.tag() + ">); an <sdf> is read by --from-sdf");
  Robot robot{.name = root.attribute("name")};
  for (const Element& each : root.children("link")) robot.links.push_back(read_link(each));
  std::vector<Placed> waiting;
  std::set<std::string> children;
  for (const Element& each : root.children("joint")) {
    waiting.push_back(read_joint(each));
    if (!children.insert(waiting.back().joint.child).second)
      each.fail("link '" + waiting.back().joint.child + "' hangs on two joints");
  }
  std::set<std::string> known;
  for (Link& each : robot.links) {
    if (children.contains(each.name)) continue;
    place(each, Eigen::Isometry3d::Identity());
    known.insert(each.name);
  }
  if (known.size() > 1) root.fail(std::to_string(known.size()) + " links hang on no joint; a URDF is one tree");
  while (!waiting.empty()) {
    const auto next = std::find_if(waiting.begin(), waiting.end(),
                                   [&](const Placed& each) { return known.contains(each.joint.parent); });
    if (next == waiting.end()) root.fail("joint '" + waiting.front().joint.name + "' hangs on no link of the tree");
    Placed placed = *next;
    waiting.erase(next);
    const auto child = std::find_if(robot.links.begin(), robot.links.end(),
                                    [&](const Link& each) { return each.name == placed.joint.child; });
    if (child == robot.links.end())
      root.fail("joint '" + placed.joint.name + "' moves the link '" + placed.joint.child + "', which is not there");
    place(*child, robot.link(placed.joint.parent)->X_ML * placed.X_PJ);
    placed.joint.axis_M = (child->X_ML.linear() * placed.axis_J).normalized();
    known.insert(child->name);
    robot.joints.push_back(placed.joint);
  }
  read_propellers(root, robot);
  return robot;
}

}  // namespace fathom::drafts
