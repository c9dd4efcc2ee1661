#include "common/drafts/robot.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "common/base/error.hpp"
#include "common/base/printable.hpp"

namespace fathom::drafts {
namespace {

constexpr double kProductWorthAWord = 0.02;  // of the smallest moment: below, three numbers say what the tensor says

const Eigen::DiagonalMatrix<double, 3> kDownward{1.0, -1.0, -1.0};  // forward, right, down from forward, left, up

std::string metres(const Eigen::Vector3d& v) {
  char text[96];
  std::snprintf(text, sizeof text, "%.4g %.4g %.4g m", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);  // no "-0"
  return text;
}

bool mentions(std::string text, const char* word) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text.find(word) != std::string::npos;
}

struct Body {
  double mass{};
  Eigen::Vector3d com_M{Eigen::Vector3d::Zero()};
  Eigen::Matrix3d inertia_M{Eigen::Matrix3d::Zero()};  // about com_M
};

Body lumped(const Robot& robot) {
  Body body;
  for (const Link& link : robot.links) {
    body.mass += link.mass;
    body.com_M += link.mass * link.com_M;
  }
  if (body.mass <= 0.0) return body;
  body.com_M /= body.mass;
  for (const Link& link : robot.links) {
    const Eigen::Vector3d d = link.com_M - body.com_M;
    body.inertia_M += link.inertia_M + link.mass * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  }
  return body;
}

void state_inertia(const Body& body, Draft& draft) {
  const Eigen::Vector3d moments = body.inertia_M.diagonal();
  if (moments.minCoeff() <= 0.0 || 2.0 * moments.maxCoeff() > moments.sum() * (1.0 + 1e-9)) {
    draft.remarks.emplace_back("The moments of inertia in the file are those of no rigid body; they are left out.");
    return;
  }
  draft.inertia = moments;
  const double product =
      std::max({std::abs(body.inertia_M(0, 1)), std::abs(body.inertia_M(0, 2)), std::abs(body.inertia_M(1, 2))});
  if (product > kProductWorthAWord * moments.minCoeff()) {
    char text[120];
    std::snprintf(text, sizeof text,
                  "Products of inertia up to %.3g kg m^2 are in the file; three moments cannot say them.", product);
    draft.remarks.emplace_back(text);
  }
}

// By plugins; where there are none, by what joints and links are called.
std::vector<Propeller> propellers_of(const Robot& robot, Draft& draft) {
  std::vector<Propeller> all = robot.propellers;
  if (all.empty()) {
    for (const Joint& joint : robot.joints) {
      for (const char* word : {"thruster", "propeller"}) {
        if (!mentions(joint.name, word) && !mentions(joint.child, word)) continue;
        all.push_back({.joint = joint.name, .number = {}, .largest = {}});
        break;
      }
    }
    draft.remarks.emplace_back(
        all.empty() ? "No thruster is in the file: the vehicle is driven by a wrench, or add 'thrusters'."
                    : "No thruster plugin is in the file: thrusters are the joints that are called so, "
                      "and push along their axes. Check places, directions and order.");
  }
  const bool numbered =
      std::all_of(all.begin(), all.end(), [](const Propeller& each) { return each.number.has_value(); });
  if (numbered) {
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return *a.number < *b.number; });
  } else if (all.size() > 1) {
    draft.remarks.emplace_back("Thrusters stand in the order of the file; put them in the order of your commands.");
  }
  return all;
}

}  // namespace

const Link* Robot::link(const std::string& wanted) const {
  const auto found = std::find_if(links.begin(), links.end(), [&](const Link& each) { return each.name == wanted; });
  return found != links.end() ? &*found : nullptr;
}

Draft draft_of(const Robot& robot, const std::string& source) {
  Draft draft{.name = robot.name,
              .remarks = {"From " + source + ": a simulator's numbers, as good as whoever wrote them."}};
  const Body body = lumped(robot);
  draft.water_density = robot.water_density;
  if (body.mass > 0.0) {
    draft.mass = body.mass;
    draft.remarks.push_back("Forward-right-down; the origin is the centre of mass of all links, " +
                            metres(kDownward * body.com_M) + " (forward, right, down) from the model's own.");
    state_inertia(body, draft);
  } else {
    draft.remarks.emplace_back("No link states a mass. Forward-right-down about the model's own origin.");
  }
  std::vector<double> largest;
  for (const Propeller& each : propellers_of(robot, draft)) {
    const auto joint = std::find_if(robot.joints.begin(), robot.joints.end(),
                                    [&](const Joint& one) { return one.name == each.joint; });
    if (joint == robot.joints.end())
      throw InputError(source + ": a thruster drives the joint '" + printable(each.joint) + "', which is not there");
    const Link* child = robot.link(joint->child);
    if (child == nullptr)
      throw InputError(source + ": joint '" + printable(joint->name) + "' moves the link '" + printable(joint->child) +
                       "', which is not there");
    // Gazebo pushes at the centre of mass of the propeller's link.
    draft.thrusters.push_back({.name = joint->name,
                               .p_BJ = kDownward * (child->com_M - body.com_M),
                               .axis_B = (kDownward * joint->axis_M).normalized(),
                               .note = {}});
    if (each.largest) largest.push_back(*each.largest);
  }
  const bool alike = !largest.empty() && largest.size() == draft.thrusters.size() &&
                     std::all_of(largest.begin(), largest.end(), [&](double f) { return f == largest.front(); });
  if (alike) draft.largest_thrust = largest.front();
  draft.remarks.insert(draft.remarks.end(), robot.remarks.begin(), robot.remarks.end());
  draft.tail =
      "\n# Beside it: 'thrust_curve' where commands are pulse widths, 'priors' of drag, 'sensors' "
      "(docs/configuration.md)\n";
  return draft;
}

}  // namespace fathom::drafts
