// docs/gallery.md and its picture: what each effect leaves in the residual of a model that does not know it. Every
// effect is simulated, and must show. FATHOM_GALLERY_RENEW=yes writes both files anew.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>

#include "common/model/rollout.hpp"
#include "common/report/plot.hpp"
#include "common/report/text.hpp"
#include "test/support/scratch.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom {
namespace {

constexpr double kDuration = 60.0, kStep = 0.05;  // s
constexpr double kShown = 30.0;                   // s
constexpr double kPlain = 0.1;                    // of the applied wrench (rms): an effect of this size is plain to see
constexpr double kFloor = 8.0;                    // times what differences leave of a residual without any effect
constexpr std::size_t kLeastDrawn = 38;           // all that there were when this was written
constexpr int kColumns = 3, kWidth = 330, kHeight = 170;
const std::string kPage = std::string{FATHOM_SOURCE_DIR} + "/docs/gallery.md";
const std::string kPicture = std::string{FATHOM_SOURCE_DIR} + "/docs/gallery.svg";

struct Leftovers {
  std::vector<double> t;
  std::vector<Vector6d> left, applied;  // N, N m
  Vector6d left_rms{Vector6d::Zero()}, applied_rms{Vector6d::Zero()};
};

/// Of the vehicle's own model without the effect, along the measured motion, at the middle of each step.
Leftovers residual_of(const model::Vehicle& vehicle, const test::VirtualDive& dive) {
  model::Model plain = dive.truth;
  plain.effects.clear();
  const Trial& trial = dive.trial;
  Leftovers all;
  for (std::size_t k = 0; k + 1 < trial.size(); ++k) {
    model::Motion motion{.t = trial.t[k] + 0.5 * trial.dt, .p_WB = 0.5 * (trial.p_WB[k] + trial.p_WB[k + 1])};
    motion.R_WB = trial.q_WB[k].slerp(0.5, trial.q_WB[k + 1]).toRotationMatrix();
    motion.nu = 0.5 * (trial.nu[k] + trial.nu[k + 1]);
    motion.force = 0.5 * (trial.input[k] + trial.input[k + 1]);
    motion.voltage = trial.voltage[k];
    motion.vehicle = &vehicle;
    const Vector6d nu_dot = (trial.nu[k + 1] - trial.nu[k]) / trial.dt;
    all.t.push_back(motion.t);
    all.left.push_back(model::residual_wrench(plain, motion, nu_dot));
    all.applied.push_back(plain.allocation * motion.force);
    all.left_rms += all.left.back().cwiseAbs2();
    all.applied_rms += all.applied.back().cwiseAbs2();
  }
  const auto n = static_cast<double>(all.t.size());
  all.left_rms = (all.left_rms / n).cwiseSqrt();
  all.applied_rms = (all.applied_rms / n).cwiseSqrt();
  return all;
}

test::DiveSettings settings() {
  return {.duration = kDuration,
          .dt = kStep,
          .step = 0.01,
          .seed = 4,
          .velocity_noise = 0.0,
          .rate_noise = 0.0,
          .spread = 0.0};
}

/// A vehicle with a dive on which no effect acts.
struct Craft {
  explicit Craft(model::Vehicle one)
      : vehicle{std::move(one)}, calm{test::make_dive(vehicle, settings())}, bare{residual_of(vehicle, calm)} {}
  Craft(const Craft&) = delete;
  Craft& operator=(const Craft&) = delete;
  model::Vehicle vehicle;
  test::VirtualDive calm;
  Leftovers bare;
};

Eigen::Index strongest(const Leftovers& residual) {
  Eigen::Index axis = 0;
  residual.left_rms.cwiseQuotient(residual.applied_rms).maxCoeff(&axis);
  return axis;
}

/// A form of the effect that this vehicle can have, where a search for it begins, made larger until it is plain to see.
std::optional<model::ActiveEffect> plain_form(const model::Effect& effect, const model::Vehicle& vehicle,
                                              const model::Scene& scene, Leftovers& residual) {
  const std::vector<std::string> variants = effect.variants(scene);
  const auto usable = std::ranges::find_if(variants, [](const std::string& name) { return name != "-"; });
  if (usable == variants.end()) return std::nullopt;
  const auto variant = static_cast<int>(usable - variants.begin());
  const std::vector<double> start = effect.starts(scene, variant).front();
  std::optional<model::ActiveEffect> best;
  for (double size = 1.0; size < 1000.0; size *= 2.0) {
    model::ActiveEffect active{.effect = &effect, .variant = variant, .variant_name = *usable, .theta = start};
    const auto parameters = effect.parameters();
    const std::size_t scaled = effect.amplitudes() > 0 ? static_cast<std::size_t>(effect.amplitudes()) : start.size();
    for (std::size_t i = 0; i < scaled; ++i)
      active.theta[i] = std::clamp(size * start[i], parameters[i].low, parameters[i].high);
    test::DiveSettings dive = settings();
    dive.effects = {active};
    residual = residual_of(vehicle, test::make_dive(vehicle, dive));
    if (!residual.left_rms.allFinite()) break;
    best = active;
    const Eigen::Index axis = strongest(residual);
    if (residual.left_rms[axis] > kPlain * residual.applied_rms[axis]) break;
  }
  return best;
}

report::Figure panel(const std::string& title, const Leftovers& residual, Eigen::Index axis) {
  report::Figure figure{
      .alt = title, .width = kWidth, .height = kHeight, .left = 44, .right = 8, .top = 24, .bottom = 34};
  std::string applied, left;
  double most = 1e-9;
  for (std::size_t k = 0; k < residual.t.size() && residual.t[k] <= kShown; k += 2) {
    const std::string t = report::plain(residual.t[k]);
    most = std::max(most, std::abs(residual.left[k][axis]));
    left += t + " " + report::plain(residual.left[k][axis]) + "\n";
    applied += t + " " + report::plain(residual.applied[k][axis]) + "\n";
  }
  const char* letter = model::kAxisNames[static_cast<std::size_t>(axis)];
  figure.script =
      "$p << EOD\n" + applied + "EOD\n$r << EOD\n" + left + "EOD\nset label 100 " +
      report::quoted(title + ": " + letter + (axis < 3 ? " [N]" : " [N m]")) +
      " at graph 0, graph 1 left offset -4, 0.8 textcolor rgb '#22262b'\nset xrange [0:" + report::plain(kShown) +
      "]\nset yrange [" + report::plain(-1.3 * most) + ":" + report::plain(1.3 * most) +
      "]\nset ytics autofreq\nset xtics 10\nset format y '%.2g'\nset xzeroaxis lt 1 lc rgb '#b8bec7' lw 1\n"
      "plot $p w l lc rgb '#c5ccd4' lw 1, $r w l lc rgb '#0a5ea8' lw 1.6\n";
  return figure;
}

std::string sheet(const std::vector<report::Figure>& figures) {
  const int rows = (static_cast<int>(figures.size()) + kColumns - 1) / kColumns;
  const std::string width = std::to_string(kColumns * kWidth), height = std::to_string(rows * kHeight);
  std::string all = "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" width=\"" +
                    width + "\" height=\"" + height + "\" viewBox=\"0 0 " + width + " " + height +
                    "\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  const std::vector<std::string> pictures = report::render(figures);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int at = static_cast<int>(i);
    std::string one = pictures[i];
    one.insert(4, " x=\"" + std::to_string(at % kColumns * kWidth) + "\" y=\"" +
                      std::to_string(at / kColumns * kHeight) + "\" width=\"" + std::to_string(kWidth) +
                      "\" height=\"" + std::to_string(kHeight) + "\"");
    all += one + "\n";
  }
  return all + "</svg>\n";
}

}  // namespace

TEST_CASE("gallery: every effect shows in the residual, and the page names each") {
  const model::Vehicle heavy = test::vehicle_from_repository("bluerov2_heavy");
  const Craft rov{heavy}, light{test::without_parameters(heavy, "G_")};  // without: a law of the model itself
  model::Vehicle sailing = heavy;  // some laws are asked of craft that live by the flow past them alone
  sailing.flow_matters = true;
  sailing.windage = 0.1;
  const Craft flying{sailing};
  model::Vehicle behind = heavy;  // no jet of this frame meets another thruster
  behind.thrusters[1].p_BJ = behind.thrusters[0].p_BJ + 0.3 * behind.thrusters[0].axis_B;
  const Craft crowded{behind};
  std::vector<report::Figure> figures;
  std::string rows;
  std::vector<std::string> begins;
  for (const model::Effect* effect : model::all_effects()) {
    CAPTURE(effect->name());
    Leftovers residual;
    std::optional<model::ActiveEffect> active;
    const Craft* flown = nullptr;
    for (const Craft* craft : {&rov, &light, &flying, &crowded}) {
      model::Scene scene = model::scene_of(craft->vehicle, {&craft->calm.trial, 1});
      if (effect->measures()) scene.position = scene.attitude = false;  // else kinematics finds it, not the residual
      flown = craft;
      active = plain_form(*effect, craft->vehicle, scene, residual);
      if (active) break;
    }
    if (!active) {
      MESSAGE(effect->name() << ": has no form on the gallery's craft");
      continue;
    }
    const Eigen::Index axis = strongest(residual);
    CHECK(residual.left_rms[axis] > kFloor * flown->bare.left_rms[axis]);
    std::string of;
    if (flown == &flying) of = " (of craft that live by the flow past them)";
    if (flown == &crowded) of = " (of a craft that has one thruster behind another)";
    const std::string title = report::effect_title(std::string{effect->name()}, active->variant_name);
    figures.push_back(panel(report::effect_title(std::string{effect->name()}), residual, axis));
    std::string numbers;
    for (std::size_t i = 0; i < active->theta.size(); ++i) {
      if (!effect->is_told(active->variant, i)) continue;
      const std::string unit{effect->unit(active->variant, i)};
      numbers += (numbers.empty() ? "" : ", ") + std::string{effect->parameters()[i].name} + " " +
                 report::number(active->theta[i], 3) + (unit.empty() ? "" : " " + unit);
    }
    const std::string begin = "| " + title + " | " + std::string{effect->sentence()} + " | ";
    rows += begin + numbers + of + " | " + std::string{effect->revealed_by()} + " |\n";
    begins.push_back(begin);
  }
  const std::string page =
      "# What each effect looks like in the residual\n\n"
      "The residual is the force, or moment, that acts and that the model does not know. Here the model knows all but "
      "the "
      "one effect:\nblue is what it leaves on the axis where that shows most, grey what the thrusters apply there. A "
      "BlueROV2 "
      "Heavy dives on all six\naxes, without noise; each effect is as large as makes "
      "it plain to see. Real residuals "
      "hold "
      "several at once, and noise: what the eye\ncannot tell apart here the diagnosis tells by what the residual goes "
      "with, or says that it cannot.\n\n![Residuals of all effects](gallery.svg)\n\n"
      "| effect | | in the picture | the motion that shows it best |\n|---|---|---|---|\n" +
      rows + "\nDrawn and checked by `test/common/report/gallery_test.cpp`.\n";
  if (std::getenv("FATHOM_GALLERY_RENEW") != nullptr) {
    std::ofstream{kPage} << page;
    std::ofstream{kPicture} << sheet(figures);
  }
  CHECK(figures.size() >= kLeastDrawn);
  const std::string kept = test::read_bytes(kPage);
  for (const std::string& begin : begins)
    CHECK_MESSAGE(kept.find(begin) != std::string::npos, begin, "not in docs/gallery.md: FATHOM_GALLERY_RENEW=yes");
  const std::string picture = test::read_bytes(kPicture);
  for (const report::Figure& figure : figures) {
    CAPTURE(figure.alt);
    CHECK(picture.find("aria-label=\"" + report::escape(figure.alt) + "\"") != std::string::npos);
  }
  CHECK(report::render({figures.front()}).size() == 1);  // gnuplot takes what is drawn
}

}  // namespace fathom
