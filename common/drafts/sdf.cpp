// SDF: poses relative to frames by name.
#include <algorithm>
#include <map>
#include <numbers>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/drafts/robot.hpp"
#include "common/drafts/xml.hpp"

namespace fathom::drafts {
namespace {

constexpr const char* kModel = "__model__";
constexpr int kDeepest = 64;  // poses that hang on poses; more is a circle

Eigen::Isometry3d pose_of(const Element& pose) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  if (pose.none() || pose.text().empty()) return X;
  if (pose.attribute("rotation_format") == "quat_xyzw") {
    const auto p = pose.numbers(pose.text(), 7);
    const Eigen::Quaterniond q{p[6], p[3], p[4], p[5]};
    if (!(std::abs(q.norm() - 1.0) < 0.01)) pose.fail("this quaternion has not the length 1");
    X.linear() = q.normalized().toRotationMatrix();
    X.translation() = Eigen::Vector3d{p[0], p[1], p[2]};
    return X;
  }
  const auto p = pose.numbers(pose.text(), 6);
  const std::string degrees = pose.attribute("degrees");
  const double scale = degrees == "true" || degrees == "1" ? std::numbers::pi / 180.0 : 1.0;
  X.linear() = rotation_from_euler(scale * Eigen::Vector3d{p[3], p[4], p[5]});
  X.translation() = Eigen::Vector3d{p[0], p[1], p[2]};
  return X;
}

/// Links, joints and frames of one model by name.
class Frames {
 public:
  explicit Frames(const Element& model) {
    for (const Element& each : model.children("link")) add(each, kModel);
    for (const Element& each : model.children("joint")) add(each, each.text_of("child"));
    for (const Element& each : model.children("frame")) {
      const std::string to = each.attribute("attached_to");
      add(each, to.empty() ? kModel : to);
    }
  }
  /// Of the frame `name` in the model.
  [[nodiscard]] Eigen::Isometry3d in_model(const std::string& name, const Element& where, int depth = 0) const {
    if (name == kModel || name.empty()) return Eigen::Isometry3d::Identity();
    const auto found = frames_.find(name);
    if (found == frames_.end()) where.fail("there is no link, joint or frame '" + name + "' in this model");
    if (depth > kDeepest) where.fail("the poses of '" + name + "' go round in a circle");
    return in_model(found->second.relative_to, where, depth + 1) * found->second.pose;
  }

 private:
  struct Frame {
    Eigen::Isometry3d pose;
    std::string relative_to;
  };
  void add(const Element& element, const std::string& usual) {
    const Element pose = element.child("pose");
    std::string to = pose.attribute("relative_to");
    if (to.empty()) to = pose.attribute("frame");  // before version 1.7
    frames_[element.attribute("name")] = {pose_of(pose), to.empty() ? usual : to};
  }
  std::map<std::string, Frame> frames_;
};

Link read_link(const Element& element, const Frames& frames, Robot& robot) {
  Link link{.name = element.attribute("name")};
  link.X_ML = frames.in_model(link.name, element);
  link.com_M = link.X_ML.translation();
  const Element inertial = element.child("inertial");
  const std::string mass = inertial.text_of("mass");
  if (mass.empty()) {
    robot.remarks.push_back("Link " + link.name + " states no mass; none is counted for it.");
    return link;
  }
  link.mass = inertial.number(mass);
  if (link.mass < 0.0) inertial.fail("a mass below zero");
  const Eigen::Isometry3d X_MI = link.X_ML * pose_of(inertial.child("pose"));
  link.com_M = X_MI.translation();
  link.inertia_M = X_MI.linear() * inertia_of(inertial.child("inertia"), false) * X_MI.linear().transpose();
  return link;
}

Joint read_joint(const Element& element, const Frames& frames) {
  Joint joint{.name = element.attribute("name"),
              .type = element.attribute("type"),
              .parent = element.text_of("parent"),
              .child = element.text_of("child")};
  const Element xyz = element.child("axis").child("xyz");
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // SDF's own where none is stated
  std::string frame = joint.name;
  if (!xyz.none()) {
    const auto v = xyz.numbers(xyz.text(), 3);
    axis = {v[0], v[1], v[2]};
    if (xyz.has("expressed_in") && !xyz.attribute("expressed_in").empty()) frame = xyz.attribute("expressed_in");
    const std::string parent = element.child("axis").text_of("use_parent_model_frame");
    if (parent == "true" || parent == "1") frame = kModel;
  }
  if (axis.norm() < 1e-6) xyz.fail("an axis of length zero");
  joint.axis_M = (frames.in_model(frame, element).linear() * axis).normalized();
  return joint;
}

// The only model, or the only one with thrusters.
Element model_of(const XmlFile& file) {
  const Element root = file.root();
  if (root.tag() != "sdf")
    root.fail("is no SDF (it begins with <" + root.tag() + ">); a <robot> is read by --from-urdf");
  std::vector<Element> all = root.children("model");
  for (const Element& world : root.children("world")) {
    for (const Element& each : world.children("model")) all.push_back(each);
  }
  if (all.empty()) root.fail("holds no <model>; models that it includes are files of their own: name one of these");
  if (all.size() == 1) return all.front();
  std::vector<Element> driven;
  for (const Element& each : all) {
    bool thrusters = false;
    each.each_below("plugin", [&](const Element& plugin) {
      for (const char* name : {"filename", "name"})
        thrusters = thrusters || plugin.attribute(name).find("hruster") != std::string::npos;
    });
    if (thrusters) driven.push_back(each);
  }
  if (driven.size() != 1)
    root.fail("holds " + std::to_string(all.size()) + " models, " + std::to_string(driven.size()) +
              " with thrusters; leave one in it");
  return driven.front();
}

}  // namespace

Robot read_sdf(const std::string& path) {
  const XmlFile file{path};
  const Element model = model_of(file);
  Robot robot{.name = model.attribute("name")};
  const Frames frames{model};
  for (const Element& each : model.children("link")) robot.links.push_back(read_link(each, frames, robot));
  for (const Element& each : model.children("joint")) {
    if (each.text_of("child").find("::") != std::string::npos) continue;  // of a model within, see below
    robot.joints.push_back(read_joint(each, frames));
  }
  for (const char* within : {"model", "include"}) {
    for (const Element& each : model.children(within)) {
      const std::string name = each.attribute("name").empty() ? each.text_of("uri") : each.attribute("name");
      robot.remarks.push_back("What is within, " + name + ", is not read: its mass and thrusters are missing here.");
    }
  }
  read_propellers(model, robot);
  return robot;
}

}  // namespace fathom::drafts
