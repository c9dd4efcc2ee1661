#include "common/consistency/conventions/reading.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "common/consistency/pairs/signed_permutation.hpp"

namespace fathom::consistency {
namespace {

using Eigen::Matrix3d;
using estimation::HeadingSense;
using estimation::QuaternionForm;
using estimation::VectorFrame;

const Matrix3d kFlip = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();  // z up, y to the left: NWU or FLU
const Matrix3d kEnu = (Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();

constexpr PriorPenalties kPrior{};

void add_attitude(std::vector<Hypothesis>& all) {
  const auto add = [&](const char* finding, const char* words, const char* map, const Reading& change) {
    all.push_back({.finding = finding, .signal = "attitude", .words = words, .map = map, .change = change});
  };
  add("quaternion_inverse", "the attitude is world-to-body, read as body-to-world",
      "quaternion: {turns: world_to_body}", {.quaternion = QuaternionForm::kInverse});
  add("quaternion_order", "the quaternion's scalar stands last, read as first", "quaternion: {order: xyzw}",
      {.quaternion = QuaternionForm::kScalarLast});
  add("quaternion_order", "the quaternion's scalar stands last and it is world-to-body",
      "quaternion: {order: xyzw, turns: world_to_body}", {.quaternion = QuaternionForm::kScalarLastInverse});
  add("heading_from_east", "the heading is counted anticlockwise from east: psi = 90 deg - logged",
      "euler: {heading: from_east}", {.sense = HeadingSense::kFromEast});
  add("heading_anticlockwise", "the heading is counted anticlockwise from north: psi = -logged",
      "euler: {heading: anticlockwise}", {.sense = HeadingSense::kAnticlockwise});
  add("axes", "the attitude is of forward-left-up axes in an east-north-up world", "world: ENU, body: FLU",
      {.attitude_world = kEnu, .attitude_axes = kFlip});
  add("axes", "the attitude is of forward-left-up axes in a north-west-up world", "world: NWU, body: FLU",
      {.attitude_world = kFlip, .attitude_axes = kFlip});
  add("axes", "the attitude is of forward-left-up axes in a north-east-down world", "world: NED, body: FLU",
      {.attitude_axes = kFlip});
  add("axes", "the attitude is of forward-right-down axes in an east-north-up world", "world: ENU, body: FRD",
      {.attitude_world = kEnu});
}

void add_position(std::vector<Hypothesis>& all) {
  all.push_back({.finding = "axes",
                 .signal = "position",
                 .words = "the position is east, north, up, read as north, east, down",
                 .map = "position: {frame: ENU}",
                 .change = {.position = kEnu}});
  all.push_back({.finding = "axes",
                 .signal = "position",
                 .words = "the position is north, west, up, read as north, east, down",
                 .map = "position: {frame: NWU}",
                 .change = {.position = kFlip}});
}

void add_vectors(std::vector<Hypothesis>& all) {
  struct World {
    const char *name, *words;
    Matrix3d axes;
  };
  const std::vector<World> worlds{{"NED", "north, east, down", Matrix3d::Identity()},
                                  {"ENU", "east, north, up", kEnu},
                                  {"NWU", "north, west, up", kFlip}};
  for (const World& world : worlds) {
    const std::string frame = std::string("frame: ") + world.name + "}";
    const std::string of = std::string(" the world's axes (") + world.words + "), not the body's";
    all.push_back({.finding = "in_world_axes",
                   .signal = "dvl",
                   .words = "u v w are along" + of,
                   .map = "velocity: {" + frame,
                   .change = {.velocity = world.axes, .velocity_frame = VectorFrame::kWorld}});
    all.push_back({.finding = "in_world_axes",
                   .signal = "gyro",
                   .words = "p q r are about" + of,
                   .map = "rates: {" + frame,
                   .change = {.rates = world.axes, .rates_frame = VectorFrame::kWorld}});
    all.push_back({.finding = "in_world_axes",
                   .signal = "twist",
                   .words = "u v w and p q r are along" + of,
                   .map = "velocity: {" + frame + " and rates: {" + frame,
                   .change = {.velocity = world.axes,
                              .rates = world.axes,
                              .velocity_frame = VectorFrame::kWorld,
                              .rates_frame = VectorFrame::kWorld}});
  }
  all.push_back({.finding = "euler_rates",
                 .signal = "gyro",
                 .words = "p q r are the rates of roll, pitch and yaw angles, not the body's",
                 .map = "rates: {frame: euler}",
                 .change = {.rates_frame = VectorFrame::kEulerRates}});
  const auto flu = [&](const char* signal, const Reading& change) {
    all.push_back({.finding = "sign",
                   .signal = signal,
                   .words = "forward-left-up axes, read as forward-right-down",
                   .map = "frame: FLU",
                   .change = change,
                   .of_sensor_axes = true});
  };
  flu("dvl", {.velocity = kFlip});
  flu("gyro", {.rates = kFlip});
  flu("twist", {.velocity = kFlip, .rates = kFlip});
  flu("accelerometer", {.force = kFlip});
  all.push_back(
      {.finding = "sign",
       .signal = "accelerometer",
       .words = "the accelerometer shows the pull of gravity, not the specific force: all three signs are turned",
       .map = "negate its columns",
       .change = {.force = -Matrix3d::Identity()},
       .of_sensor_axes = true});
}

void add_joint(std::vector<Hypothesis>& all) {
  all.push_back({.finding = "axes",
                 .signal = "pose",
                 .words = "position and attitude are in an east-north-up world, the attitude of forward-left-up axes",
                 .map = "position: {frame: ENU} and attitude: world: ENU, body: FLU",
                 .change = {.attitude_world = kEnu, .attitude_axes = kFlip, .position = kEnu}});
  all.push_back({.finding = "axes",
                 .signal = "pose",
                 .words = "position and attitude are in a north-west-up world, the attitude of forward-left-up axes",
                 .map = "position: {frame: NWU} and attitude: world: NWU, body: FLU",
                 .change = {.attitude_world = kFlip, .attitude_axes = kFlip, .position = kFlip}});
  all.push_back({.finding = "heading_offset",
                 .signal = "attitude",
                 .words = "the attitude's heading is turned against position and velocity",
                 .map = "",
                 .kind = Kind::kHeading,
                 .change = {.free_heading = true}});
}

void add_axes(std::vector<Hypothesis>& all) {
  for (const bool proper : {true, false}) {
    const Kind kind = proper ? Kind::kTurn : Kind::kReflection;
    for (const Matrix3d& axes : signed_permutations()) {
      if ((axes.determinant() > 0.0) != proper || axes.isIdentity()) continue;
      const auto add = [&](const char* signal, const char* words, const Reading& change, bool sensor) {
        all.push_back({.finding = axes.isDiagonal() ? "sign" : "axes",
                       .signal = signal,
                       .words = words + describe_axes(axes),
                       .map = "columns in another order, or with other signs",
                       .kind = kind,
                       .change = change,
                       .of_sensor_axes = sensor,
                       .size = axes.isDiagonal() ? -1.0 : 1.0});
      };
      add("position", "the position's axes are others: ", {.position = axes}, false);
      if (proper) add("attitude", "the attitude is of body axes that are turned: ", {.attitude_axes = axes}, false);
      add("dvl", "the velocity log's axes are others: ", {.velocity = axes}, true);
      add("gyro", "the gyro's axes are others: ", {.rates = axes}, true);
      if (proper) add("accelerometer", "the accelerometer's axes are others: ", {.force = axes}, true);
    }
  }
}

}  // namespace

double penalty(Kind kind) {
  switch (kind) {
    case Kind::kNamed:
      return kPrior.named;
    case Kind::kHeading:
      return kPrior.heading;
    case Kind::kTurn:
      return kPrior.turn;
    default:
      return kPrior.reflection;
  }
}

const std::vector<Hypothesis>& hypotheses() {
  static const std::vector<Hypothesis> all = [] {
    std::vector<Hypothesis> list;
    add_attitude(list);
    add_position(list);
    add_vectors(list);
    add_joint(list);
    add_axes(list);
    return list;
  }();
  return all;
}

bool compose(const Reading& first, const Reading& change, Reading& both) {
  both = first;
  bool free = true;
  const auto take = [&](auto member, const auto& neutral) {
    if (change.*member == neutral) return;
    free = free && both.*member == neutral;
    both.*member = change.*member;
  };
  const Matrix3d none = Matrix3d::Identity();
  take(&Reading::quaternion, QuaternionForm::kAsRead);
  take(&Reading::sense, HeadingSense::kAsRead);
  take(&Reading::attitude_world, none);
  take(&Reading::attitude_axes, none);
  take(&Reading::position, none);
  take(&Reading::velocity, none);
  take(&Reading::rates, none);
  take(&Reading::force, none);
  take(&Reading::velocity_frame, VectorFrame::kBody);
  take(&Reading::rates_frame, VectorFrame::kBody);
  take(&Reading::free_heading, false);
  // A vector along the world's axes, whose axes were changed as the body's, would be two statements about one thing.
  if (change.velocity_frame != VectorFrame::kBody && first.velocity != none) free = false;
  if (change.velocity != none && first.velocity_frame != VectorFrame::kBody) free = false;
  if (change.rates_frame != VectorFrame::kBody && first.rates != none) free = false;
  if (change.rates != none && first.rates_frame != VectorFrame::kBody) free = false;
  return free;
}

std::string describe_axes(const Matrix3d& axes, const char* letters) {
  std::string text;
  for (int row = 0; row < 3; ++row) {
    int column = 0;
    axes.row(row).cwiseAbs().maxCoeff(&column);
    text += std::string(row == 0 ? "" : ", ") + letters[row] + " = " + (axes(row, column) < 0.0 ? "-" : "+") +
            letters[column];
  }
  return text;
}

}  // namespace fathom::consistency
