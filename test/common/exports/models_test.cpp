// Exported models flown beside our own simulation, each by a reader that knows the format's documentation alone: other
// signs, other frames, the same trajectory.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "common/base/error.hpp"
#include "common/exports/models/formats.hpp"
#include "common/model/dynamics.hpp"
#include "test/support/schema.hpp"

namespace fathom {
namespace {

constexpr double kStep = 0.01;       // s
constexpr int kSteps = 2000;         // 20 s
constexpr double kTolerance = 1e-6;  // m: both sides integrate alike, what differs is rounding

const std::string kVehicle = R"(name: Test ROV 1
dof: [surge, sway, heave, roll, pitch, yaw]
mass: 11.5 kg
inertia: 0.16 0.20 0.17 kg m^2
water_density: 1025 kg/m^3
priors:  # replaced by an export
  m_X: {mean: 17 kg, sigma: 5 kg}
thrusters: []
)";

model::Vehicle vehicle_file(const test::Scratch& scratch, const std::string& text = kVehicle) {
  std::string body = text.substr(0, text.find("thrusters: []"));
  test::write_bytes(scratch.path("v.yaml"), body);
  return model::Vehicle::load(scratch.path("v.yaml"));
}

result::Stored stored() {
  result::Stored s;
  s.path = "result.json";
  s.version = "1.0";
  s.result.verdict = "effect";
  const std::vector<std::pair<std::string, double>> numbers{
      {"m_X", 17.0},     {"m_Y", 24.2},     {"m_Z", 26.1},     {"I_X", 0.28},    {"I_Y", 0.32},    {"I_Z", 0.29},
      {"X_u", -4.0},     {"Y_v", -6.2},     {"Z_w", -5.2},     {"K_p", -0.3},    {"M_q", -0.4},    {"N_r", -0.5},
      {"X_u|u|", -18.2}, {"Y_v|v|", -21.7}, {"Z_w|w|", -37.0}, {"K_p|p|", -1.5}, {"M_q|q|", -1.6}, {"N_r|r|", -1.55},
      {"W-B", -1.3},     {"G_x", 0.2},      {"G_y", -0.1},     {"G_z", 2.3}};
  for (const auto& [name, value] : numbers)
    s.result.parameters_after.push_back(
        {name, value, 0.05 * std::abs(value), std::string(model::unit(*model::parameter_from_name(name))), {}});
  EffectFound lag{.name = "thruster_lag", .variant = ""};
  lag.parameters = {{"time_constant", 0.2, 0.01, "s", {}}};
  s.result.effects = {lag};
  return s;
}

/// The wrench of the manoeuvre, forward-right-down.
Vector6d wrench(double t) {
  Vector6d tau;
  tau << 12.0 + 6.0 * std::sin(0.7 * t), 8.0 * std::sin(0.5 * t), -5.0 * std::cos(0.4 * t), 0.3 * std::sin(t),
      0.5 * std::sin(0.9 * t), 0.8 * std::cos(0.3 * t);
  return tau;
}

struct State {
  Eigen::Vector3d p{0.5, -0.3, 4.0};  // world north-east-down
  Eigen::Quaterniond q{Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.3, -0.5, 0.81).normalized())};
  Vector6d nu{(Vector6d() << 0.2, -0.1, 0.05, 0.02, -0.03, 0.1).finished()};
};

/// Runge-Kutta of fourth order with body velocities; `acceleration(t, q, nu)`.
template <class Acceleration>
State flown(State s, Acceleration&& acceleration) {
  struct Slope {
    Eigen::Vector3d p;
    Eigen::Vector4d q;
    Vector6d nu;
  };
  const auto slope = [&](double t, const State& at) {
    const Eigen::Quaterniond q = at.q.normalized();
    const Eigen::Vector3d w = at.nu.tail<3>();
    const Eigen::Quaterniond turn = q * Eigen::Quaterniond(0.0, 0.5 * w.x(), 0.5 * w.y(), 0.5 * w.z());
    return Slope{q * at.nu.head<3>(), turn.coeffs(), acceleration(t, q, at.nu)};
  };
  const auto moved = [](State at, const Slope& by, double dt) {
    at.p += dt * by.p;
    at.q.coeffs() += dt * by.q;
    at.nu += dt * by.nu;
    return at;
  };
  for (int k = 0; k < kSteps; ++k) {
    const double t = kStep * k;
    const Slope a = slope(t, s), b = slope(t + kStep / 2, moved(s, a, kStep / 2)),
                c = slope(t + kStep / 2, moved(s, b, kStep / 2)), d = slope(t + kStep, moved(s, c, kStep));
    s.p += kStep / 6 * (a.p + 2 * b.p + 2 * c.p + d.p);
    s.q.coeffs() += kStep / 6 * (a.q + 2 * b.q + 2 * c.q + d.q);
    s.nu += kStep / 6 * (a.nu + 2 * b.nu + 2 * c.nu + d.nu);
    s.q.normalize();
  }
  return s;
}

/// Our own simulation.
State our_flight(const model::Vehicle& vehicle, const result::Stored& s) {
  model::Model model = model::nominal_model(vehicle, true);
  for (const NamedValue& n : s.result.parameters_after)
    model.theta[model::index(*model::parameter_from_name(n.name))] = n.value;
  return flown({}, [&](double t, const Eigen::Quaterniond& q, const Vector6d& nu) {
    model::Motion motion;
    motion.t = t;
    motion.R_WB = q.toRotationMatrix();
    motion.nu = nu;
    motion.force = wrench(t);
    return model::acceleration(model, motion);
  });
}

/// What a simulator with z up and a body forward-left-up reads from a file.
struct UpCraft {
  double mass{}, density{}, gravity{9.81}, volume{};
  Eigen::Vector3d inertia, centre;  // of buoyancy
  Vector6d added, linear, quadratic;
};

State flipped(State s) {
  const Eigen::DiagonalMatrix<double, 3> flip{1.0, -1.0, -1.0};
  s.p = flip * s.p;
  s.q = Eigen::Quaterniond(s.q.w(), s.q.x(), -s.q.y(), -s.q.z());
  s.nu.head<3>() = flip * s.nu.head<3>();
  s.nu.tail<3>() = flip * s.nu.tail<3>();
  return s;
}

/// Newton and Euler with z up, in forward-left-up; the end in our frames.
State flight_of(const UpCraft& craft) {
  const State end = flown(flipped(State{}), [&](double t, const Eigen::Quaterniond& q, const Vector6d& nu) {
    Vector6d inertia = craft.added;
    inertia.head<3>().array() += craft.mass;
    inertia.tail<3>() += craft.inertia;
    const Eigen::Vector3d v = nu.head<3>(), w = nu.tail<3>();
    const Eigen::Vector3d P = inertia.head<3>().cwiseProduct(v), L = inertia.tail<3>().cwiseProduct(w);
    const Eigen::Vector3d up = q.inverse() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d buoyancy = craft.density * craft.gravity * craft.volume * up;
    Vector6d tau = wrench(t);
    for (const int i : {1, 2, 4, 5}) tau[i] = -tau[i];
    const Vector6d drag = (craft.linear.array() + craft.quadratic.array() * nu.array().abs()) * nu.array();
    Vector6d load = tau + drag;
    load.head<3>() += buoyancy - craft.mass * craft.gravity * up - w.cross(P);
    load.tail<3>() += craft.centre.cross(buoyancy) - w.cross(L) - v.cross(P);
    return Vector6d(load.cwiseQuotient(inertia));
  });
  return flipped(end);
}

void check_same(const State& a, const State& b) {
  CHECK((a.p - b.p).norm() < kTolerance);
  CHECK((a.nu - b.nu).norm() < kTolerance);
  CHECK(a.q.angularDistance(b.q) < kTolerance);
  CHECK((a.p - State{}.p).norm() > 1.0);  // it went somewhere
}

std::string inside(const std::string& text, const std::string& tag) {
  std::smatch found;
  REQUIRE_MESSAGE(std::regex_search(text, found, std::regex("<" + tag + ">([^<]*)</" + tag + ">")), tag);
  return found[1];
}

std::vector<double> numbers(const std::string& text) {
  std::istringstream stream{text};
  std::vector<double> all;
  for (double value; stream >> value;) all.push_back(value);
  return all;
}

double number(const std::string& text, const std::string& tag) { return std::stod(inside(text, tag)); }

Vector6d six(const std::vector<double>& values) {
  REQUIRE(values.size() == 6);
  return Eigen::Map<const Vector6d>(values.data());
}

struct Exporting {
  test::Scratch scratch;
  model::Vehicle vehicle = vehicle_file(scratch);
  result::Stored result = stored();
  exports::Craft craft = exports::craft_of(result, vehicle);
  State ours = our_flight(vehicle, result);
  [[nodiscard]] exports::ModelFile file(const std::string& to) const {
    return exports::model_file(to, craft, result, kVehicle);
  }
};

}  // namespace

TEST_CASE("models: Gazebo's SDF flies as we do") {
  const Exporting e;
  const exports::ModelFile file = e.file("gz");
  const std::string& text = file.text;
  UpCraft craft{.mass = number(text, "mass"), .density = number(text, "water_density")};
  craft.inertia = {number(text, "ixx"), number(text, "iyy"), number(text, "izz")};
  craft.added = six({number(text, "xx"), number(text, "yy"), number(text, "zz"), number(text, "pp"), number(text, "qq"),
                     number(text, "rr")});
  craft.linear = six({number(text, "xU"), number(text, "yV"), number(text, "zW"), number(text, "kP"),
                      number(text, "mQ"), number(text, "nR")});
  craft.quadratic = six({number(text, "xUabsU"), number(text, "yVabsV"), number(text, "zWabsW"), number(text, "kPabsP"),
                         number(text, "mQabsQ"), number(text, "nRabsR")});
  const auto box = numbers(inside(text, "size")), pose = numbers(inside(text, "pose"));
  craft.volume = box[0] * box[1] * box[2];
  craft.centre = {pose[0], pose[1], pose[2]};
  CHECK(craft.linear.maxCoeff() < 0.0);  // stability derivatives brake where they are negative
  CHECK(craft.added.minCoeff() > 0.0);
  CHECK(craft.centre.z() > 0.0);  // above the centre of mass: it rights itself
  check_same(flight_of(craft), e.ours);
  CHECK(text.find("<xUU>") ==
        std::string::npos);  // what older releases called quadratic drag, and newer take otherwise
  CHECK(text.find("thruster lag (time_constant = 0.2") != std::string::npos);  // what it cannot say
}

TEST_CASE("models: UUV simulator's plugin flies as we do") {
  const Exporting e;
  const std::string text = e.file("uuv").text;
  UpCraft craft{
      .mass = number(text, "mass"), .density = number(text, "fluid_density"), .volume = number(text, "volume")};
  craft.inertia = {number(text, "ixx"), number(text, "iyy"), number(text, "izz")};
  const auto matrix = numbers(inside(text, "added_mass"));
  REQUIRE(matrix.size() == 36);
  for (std::size_t i = 0; i < 6; ++i) craft.added[static_cast<Eigen::Index>(i)] = matrix[7 * i];
  // HydrodynamicModel.cc: damping = -D v with D = -linear - quadratic |v|.
  craft.linear = six(numbers(inside(text, "linear_damping")));
  craft.quadratic = six(numbers(inside(text, "quadratic_damping")));
  const auto centre = numbers(inside(text, "center_of_buoyancy"));
  craft.centre = {centre[0], centre[1], centre[2]};
  check_same(flight_of(craft), e.ours);
}

TEST_CASE("models: Stonefish is told what it can be told, and the file says what it computes by itself") {
  const Exporting e;
  const exports::ModelFile file = e.file("stonefish");
  const auto attribute = [&](const std::string& start) {
    std::smatch found;
    REQUIRE(std::regex_search(file.text, found, std::regex("<" + start + "=\"([^\"]*)\"")));
    return numbers(found[1]);
  };
  CHECK(attribute("mass value")[0] == 11.5);
  CHECK(attribute("inertia xyz") == std::vector{0.16, 0.20, 0.17});
  const auto box = attribute("dimensions xyz"), origin = attribute("origin xyz");
  const double density = attribute("water density")[0], buoyancy = density * 9.81 * box[0] * box[1] * box[2];
  CHECK(11.5 * 9.81 - buoyancy == doctest::Approx(-1.3));
  CHECK(-buoyancy * origin[2] == doctest::Approx(2.3));  // forward-right-down: above is negative
  CHECK(file.text.find("quadratic drag, X_u|u| .. N_r|r| (computed from the shape instead): -18.2 -21.7") !=
        std::string::npos);
  CHECK(file.text.find("--", file.text.find("<!--") + 4) == file.text.find("-->"));  // a comment that XML takes
}

TEST_CASE("models: HoloOcean's module flies as we do, in HoloOcean's world") {
  if (!test::python_has("numpy")) return;
  const Exporting e;
  test::write_bytes(e.scratch.path("rov.py"), e.file("holoocean").text);
  test::write_bytes(e.scratch.path("fly.py"), R"(
import numpy, rov
def wrench(t):
    return numpy.array([12 + 6 * numpy.sin(.7 * t), 8 * numpy.sin(.5 * t), -5 * numpy.cos(.4 * t), .3 * numpy.sin(t),
                        .5 * numpy.sin(.9 * t), .8 * numpy.cos(.3 * t)])
def product(a, b):
    x, y, z, w = a; X, Y, Z, W = b
    return numpy.array([w*X + x*W + y*Z - z*Y, w*Y - x*Z + y*W + z*X, w*Z + x*Y - y*X + z*W, w*W - x*X - y*Y - z*Z])
def slope(t, s):  # p v q w, all in north-west-up
    q = s[6:10] / numpy.linalg.norm(s[6:10])
    sensor = numpy.concatenate([numpy.zeros(3), s[3:6], s[:3], numpy.zeros(3), s[10:13], q])
    a = rov.accelerations(sensor, wrench(t))
    return numpy.concatenate([s[3:6], a[:3], .5 * product(numpy.append(s[10:13], 0), q), a[3:]])
flip = numpy.array([1., -1., -1.])
axis = numpy.array([.3, -.5, .81]); axis /= numpy.linalg.norm(axis)
q = numpy.append(numpy.sin(.2) * flip * axis, numpy.cos(.2))
R = rov.rotation(q)
s = numpy.concatenate([flip * [.5, -.3, 4.], R @ (flip * [.2, -.1, .05]), q, R @ (flip * [.02, -.03, .1])])
h = .01
for k in range(2000):
    t = h * k
    a = slope(t, s); b = slope(t + h/2, s + h/2 * a); c = slope(t + h/2, s + h/2 * b); d = slope(t + h, s + h * c)
    s = s + h/6 * (a + 2*b + 2*c + d)
    s[6:10] /= numpy.linalg.norm(s[6:10])
print(*(flip * s[:3]), *(flip * (rov.rotation(s[6:10]).T @ s[3:6])))
)");
  const test::Ran ran =
      test::shell("cd '" + e.scratch.path("") + "' && PYTHONDONTWRITEBYTECODE=1 " + test::kDebianPython + " fly.py");
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const auto end = numbers(ran.text);
  REQUIRE(end.size() == 6);
  // Another integration (velocities in the world): the same to its error, not to rounding.
  constexpr double kOther = 1e-4;
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(std::abs(end[i] - e.ours.p[static_cast<Eigen::Index>(i)]) < kOther);
    CHECK(std::abs(end[3 + i] - e.ours.nu[static_cast<Eigen::Index>(i)]) < kOther);
  }
}

TEST_CASE("models: the MSS function holds the numbers of our own frames") {
  const Exporting e;
  const std::string text = e.file("mss").text;
  const auto list = [&](const std::string& name) {
    std::smatch found;
    REQUIRE_MESSAGE(std::regex_search(text, found, std::regex("\n" + name + " = (?:diag\\()?\\[([^\\]]*)\\]")), name);
    std::string inner = found[1];
    std::ranges::replace(inner, ';', ' ');
    return numbers(inner);
  };
  const Vector6d inertia = six(list("M_RB")) + six(list("M_A"));
  CHECK(inertia[1] == doctest::Approx(24.2));
  CHECK(inertia[5] == doctest::Approx(0.29));
  const Vector6d linear = six(list("D_linear")), quadratic = six(list("D_quadratic"));
  const auto G = list("G");
  std::smatch weight;
  REQUIRE(std::regex_search(text, weight, std::regex("\nW_B = ([^;]*);")));
  const double sinking = std::stod(weight[1]);
  const State end = flown({}, [&](double t, const Eigen::Quaterniond& q, const Vector6d& nu) {
    const Eigen::Vector3d v = nu.head<3>(), w = nu.tail<3>(), down = q.inverse() * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d P = inertia.head<3>().cwiseProduct(v), L = inertia.tail<3>().cwiseProduct(w);
    Vector6d load = wrench(t);
    load.array() += (linear.array() + quadratic.array() * nu.array().abs()) * nu.array();
    load.head<3>() += sinking * down - w.cross(P);
    load.tail<3>() += Eigen::Vector3d(G[0], G[1], G[2]).cross(down) - w.cross(L) - v.cross(P);
    return Vector6d(load.cwiseQuotient(inertia));
  });
  check_same(end, e.ours);
  CHECK(text.starts_with("function xdot = test_rov_1(x, tau)\n"));
}

TEST_CASE("models: the vehicle's file with identified priors is a vehicle's file, and flies as we do") {
  const Exporting e;
  const exports::ModelFile file = e.file("vehicle");
  const model::Vehicle again = vehicle_file(e.scratch, file.text.substr(0, file.text.find("thrusters: []")) +
                                                           file.text.substr(file.text.find("\n# Identified")));
  CHECK(again.mass == 11.5);
  result::Stored from_file = e.result;
  from_file.result.parameters_after.clear();
  for (std::size_t i = 0; i < again.parameters.size(); ++i)
    from_file.result.parameters_after.push_back({again.parameters[i], again.priors[i].mean, 0.0, "", {}});
  check_same(our_flight(again, from_file), e.ours);
  const auto m_X = std::ranges::find(again.parameters, "m_X") - again.parameters.begin();
  CHECK(again.priors[static_cast<std::size_t>(m_X)].sigma == doctest::Approx(0.85));
}

TEST_CASE("models: JSON has everything, the effects and their intervals too") {
  Exporting e;
  e.result.given.covariance_of = {"X_u", "m_X"};
  e.result.given.covariance = {4.0, -0.5, -0.5, 0.25};
  const auto file = nlohmann::json::parse(e.file("json").text);
  CHECK(file.at("added_mass")[0].get<double>() == doctest::Approx(5.5));
  CHECK(file.at("effects")[0].at("parameters").at("time_constant").at("value") == 0.2);
  CHECK(file.at("covariance").at("matrix")[1][1] == 0.25);
  CHECK(file.at("centre_of_buoyancy")[2].get<double>() < 0.0);
}

TEST_CASE("models: what is not known is refused or said, not made up") {
  const test::Scratch scratch;
  result::Stored bare = stored();
  std::erase_if(bare.result.parameters_after, [](const NamedValue& n) { return n.name == "I_X" || n.name == "K_p"; });
  const exports::Craft craft = exports::craft_of(bare, vehicle_file(scratch));
  CHECK(craft.added[3] == 0.0);
  CHECK(craft.notes.front().starts_with("roll was not identified"));
  std::string without = kVehicle;
  without.erase(without.find("inertia:"), without.find("water_density") - without.find("inertia:"));
  const std::string said =
      test::complaint_of<InputError>([&] { (void)exports::craft_of(bare, vehicle_file(scratch, without)); });
  CHECK(said.find("roll was not identified, and the vehicle's file states no inertia") != std::string::npos);
  result::Stored none;
  none.result.verdict = "no_model";
  CHECK(test::complaint_of<InputError>([&] {
          (void)exports::craft_of(none, vehicle_file(scratch));
        }).find("there is no model to export") != std::string::npos);
  result::Stored light = stored();
  light.result.parameters_after[0].value = 9.0;  // less than it weighs
  const exports::Craft thin = exports::craft_of(light, vehicle_file(scratch));
  CHECK(thin.mass == 9.0);
  CHECK(thin.notes.front().find("not physical") != std::string::npos);
  CHECK_THROWS_AS((void)exports::model_file("simulink", craft, bare, kVehicle), InputError);
}

}  // namespace fathom
