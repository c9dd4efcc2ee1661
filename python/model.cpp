// Python module fathom._model: a vehicle with identified numbers, its accelerations and its flights. All arrays are
// rows of time; shapes, defaults and units are what fathom/model.py says.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/model/learned/learned_file.hpp"
#include "common/model/open_scene.hpp"
#include "common/model/rollout.hpp"

namespace fathom::python {
namespace {

namespace py = pybind11;
using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Numbers = std::vector<std::pair<std::string, double>>;

/// An effect of a result: name, form, numbers.
using EffectGiven = std::tuple<std::string, std::string, Numbers>;

class Flyer {
 public:
  /// `result`: path of result.json; empty: the vehicle file's priors.
  Flyer(const std::string& path, bool wrench, const std::string& result, const std::vector<EffectGiven>& effects)
      : vehicle_{model::Vehicle::load(path)}, model_{model::nominal_model(vehicle_, wrench)} {
    if (!result.empty()) {
      model::LearnedModel learned = model::read_learned(result, vehicle_);
      for (const auto& [name, value] : learned.parameters)
        model_.theta[model::index(*model::parameter_from_name(name))] = value;
      force_ = std::move(learned.force);
    }
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (vehicle_.dof[axis] && !(model_.theta[static_cast<Eigen::Index>(axis)] > 0.0))
        throw InputError(path + ": no inertia is known of axis " + model::kAxisNames[axis]);
    }
    for (const EffectGiven& effect : effects) add(effect);
    if (force_) model_.add({.effect = force_.get()});
  }
  Flyer(const Flyer&) = delete;
  Flyer& operator=(const Flyer&) = delete;

  [[nodiscard]] std::size_t actuators() const { return static_cast<std::size_t>(model_.allocation.cols()); }
  [[nodiscard]] const std::vector<std::string>& unflown() const { return unflown_; }
  [[nodiscard]] std::vector<std::string> thrusters() const {
    std::vector<std::string> names;
    for (const model::Thruster& thruster : vehicle_.thrusters) names.push_back(thruster.name);
    return names;
  }
  [[nodiscard]] std::array<bool, 6> dof() const { return vehicle_.dof; }
  [[nodiscard]] const std::string& name() const { return vehicle_.name; }
  [[nodiscard]] std::map<std::string, double> parameters() const {
    std::map<std::string, double> numbers;
    for (const model::BaseParameter each : model::base_parameters())
      numbers[std::string{model::name(each)}] = model_.theta[model::index(each)];
    return numbers;
  }
  [[nodiscard]] std::vector<std::string> effects() const {
    std::vector<std::string> names;
    for (const model::ActiveEffect& active : model_.effects) names.emplace_back(active.effect->name());
    return names;
  }

  [[nodiscard]] Rows thrust(const Rows& pwm, const Rows& voltage) const {
    const std::size_t rows = count(pwm, vehicle_.thrusters.size(), "pwm");
    if (vehicle_.curve.empty()) throw InputError(vehicle_.name + ": the vehicle file has no thrust curve");
    static_cast<void>(count(voltage, 1, "voltage", rows));
    Rows out({rows, vehicle_.thrusters.size()});
    for (std::size_t k = 0; k < rows; ++k) {
      for (std::size_t i = 0; i < vehicle_.thrusters.size(); ++i)
        out.mutable_at(k, i) = vehicle_.curve.force_at(pwm.at(k, i), vehicle_.thrusters[i].pwm_sign, voltage.at(k, 0));
    }
    return out;
  }

  /// Effects with a memory are at rest in that motion, as after a long while of it.
  [[nodiscard]] Rows acceleration(const Rows& t, const Rows& position, const Rows& attitude, const Rows& nu,
                                  const Rows& force, const Rows& voltage) const {
    const std::size_t rows = count(nu, 6, "nu");
    static_cast<void>(count(t, 1, "t", rows));
    static_cast<void>(count(position, 3, "position", rows));
    static_cast<void>(count(attitude, 3, "attitude", rows));
    static_cast<void>(count(force, actuators(), "force", rows));
    static_cast<void>(count(voltage, 1, "voltage", rows));
    Rows out({rows, std::size_t{6}});
    std::vector<double> memory(static_cast<std::size_t>(model_.memory_size()));
    for (std::size_t k = 0; k < rows; ++k) {
      const std::vector<Eigen::VectorXd> held(2, vector_of(force, k));
      const model::InputSignal input{t.at(k, 0), 1.0, held};
      model::Motion motion;
      motion.t = t.at(k, 0);
      motion.p_WB = vector_of(position, k);
      motion.R_WB = rotation_from_euler(vector_of(attitude, k));
      motion.nu = vector_of(nu, k);
      motion.force = held.front();
      motion.voltage = voltage.at(k, 0);
      motion.input = &input;
      motion.vehicle = &vehicle_;
      model::settle(model_, motion, memory);
      model::feel(model_, motion, memory, 0.0);
      const Vector6d nu_dot = model::acceleration(model_, motion);
      std::copy(nu_dot.data(), nu_dot.data() + 6, out.mutable_data(k, 0));
    }
    return out;
  }

  /// Position, attitude and velocity at every row of `force`, `dt` apart. Axes that the vehicle file leaves out rest.
  [[nodiscard]] std::tuple<Rows, Rows, Rows> fly(double t0, double dt, const Rows& position, const Rows& attitude,
                                                 const Rows& nu, const Rows& force, const Rows& voltage) const {
    const std::size_t rows = count(force, actuators(), "force");
    if (rows < 2 || !(dt > 0.0)) throw InputError("a flight needs two times at least, in order");
    static_cast<void>(count(position, 3, "position", 1));
    static_cast<void>(count(attitude, 3, "attitude", 1));
    static_cast<void>(count(nu, 6, "nu", 1));
    static_cast<void>(count(voltage, 1, "voltage", rows));
    Trial trial{.dt = dt, .observed = {.position = true, .attitude = true, .velocity = true, .rates = true}};
    trial.p_WB.assign(rows, vector_of(position, 0));
    trial.q_WB.assign(rows, Eigen::Quaterniond{rotation_from_euler(vector_of(attitude, 0))});
    trial.nu.assign(rows, Vector6d::Zero());
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      if (vehicle_.dof[static_cast<std::size_t>(axis)]) trial.nu.front()[axis] = nu.at(0, axis);
    }
    trial.input_is_wrench = vehicle_.thrusters.empty() || model_.allocation.cols() != vehicle_.allocation.cols();
    trial.input_step = dt;
    for (std::size_t k = 0; k < rows; ++k) {
      trial.t.push_back(t0 + static_cast<double>(k) * dt);
      trial.input.push_back(vector_of(force, k));
      trial.voltage.push_back(voltage.at(k, 0));
    }
    model::VelocityTrace velocity;
    model::PoseTrace pose;
    bool flown{};
    {
      const py::gil_scoped_release others;
      flown = model::rollout(model_, {&trial, 0, rows}, trial.nu.front(), {}, velocity, pose);
    }
    if (!flown)
      throw InputError("the motion diverges: the model's numbers, or the forces, are beyond what it can tell");
    Rows p({rows, std::size_t{3}}), euler({rows, std::size_t{3}}), v({rows, std::size_t{6}});
    for (std::size_t k = 0; k < rows; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      const Eigen::Vector3d angles = euler_from_rotation(pose.q_WB[k].toRotationMatrix());
      std::copy_n(pose.p_WB.col(at).data(), 3, p.mutable_data(k, 0));
      std::copy_n(angles.data(), 3, euler.mutable_data(k, 0));
      std::copy_n(velocity.col(at).data(), 6, v.mutable_data(k, 0));
    }
    return {p, euler, v};
  }

 private:
  void add(const EffectGiven& given) {
    const auto& [name, form, numbers] = given;
    const std::string words = form.empty() ? name : name + " (" + form + ")";
    const model::Effect* effect = model::find_effect(name);
    if (effect == nullptr) {
      unflown_.push_back(words + ": not known to this version");
      return;
    }
    if (effect->measures()) {
      unflown_.push_back(words + ": belongs to a sensor, not to the vehicle");
      return;
    }
    const bool wrench = vehicle_.thrusters.empty() || model_.allocation.cols() != vehicle_.allocation.cols();
    model::Scene scene = model::open_scene(vehicle_, wrench);
    std::vector<std::string> forms = effect->variants(scene);
    auto found = std::ranges::find(forms, form);
    if (found == forms.end()) {
      scene.voltage = false;
      forms = effect->variants(scene);
      found = std::ranges::find(forms, form);
    }
    if (found == forms.end() || form == "-") {
      unflown_.push_back(words + ": this vehicle file does not have that form");
      return;
    }
    model::ActiveEffect active{.effect = effect,
                               .variant = static_cast<int>(found - forms.begin()),
                               .variant_name = form,
                               .theta = std::vector<double>(effect->parameters().size(), 0.0)};
    for (const auto& [number, value] : numbers) {
      const auto parameter = std::ranges::find(effect->parameters(), number, &model::EffectParameter::name);
      if (parameter == effect->parameters().end()) throw InputError(name + ": has no number " + number);
      active.theta[static_cast<std::size_t>(parameter - effect->parameters().begin())] = value;
    }
    model_.add(std::move(active));
  }

  static std::size_t count(const Rows& rows, std::size_t width, const char* name, std::size_t wanted = 0) {
    if (rows.ndim() != 2 || static_cast<std::size_t>(rows.shape(1)) != width ||
        (wanted > 0 && static_cast<std::size_t>(rows.shape(0)) != wanted))
      throw InputError(std::string{name} + ": rows of " + std::to_string(width) +
                       " numbers are needed, as many as times");
    const double* numbers = rows.data();
    if (!std::all_of(numbers, numbers + rows.size(), [](double x) { return std::isfinite(x); }))
      throw InputError(std::string{name} + ": holds what is no number");
    return static_cast<std::size_t>(rows.shape(0));
  }
  static Eigen::VectorXd vector_of(const Rows& rows, std::size_t k) {
    return Eigen::Map<const Eigen::VectorXd>(rows.data(k, 0), rows.shape(1));
  }

  model::Vehicle vehicle_;
  model::Model model_;  // points at vehicle_
  std::shared_ptr<const model::LearnedForce> force_;
  std::vector<std::string> unflown_;
};

}  // namespace
}  // namespace fathom::python

PYBIND11_MODULE(_model, m) {
  namespace py = pybind11;
  using fathom::python::Flyer;
  m.doc() = "Vehicle models of Fathom; fathom.Model wraps this.";
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      if (error) std::rethrow_exception(error);
    } catch (const fathom::InputError& bad) {
      PyErr_SetString(PyExc_ValueError, bad.what());
    }
  });
  py::class_<Flyer>(m, "Flyer")
      .def(py::init<const std::string&, bool, const std::string&, const std::vector<fathom::python::EffectGiven>&>())
      .def_property_readonly("actuators", &Flyer::actuators)
      .def_property_readonly("parameters", &Flyer::parameters)
      .def_property_readonly("effects", &Flyer::effects)
      .def_property_readonly("unflown", &Flyer::unflown)
      .def_property_readonly("thrusters", &Flyer::thrusters)
      .def_property_readonly("dof", &Flyer::dof)
      .def_property_readonly("name", &Flyer::name)
      .def("thrust", &Flyer::thrust)
      .def("acceleration", &Flyer::acceleration)
      .def("fly", &Flyer::fly);
}
