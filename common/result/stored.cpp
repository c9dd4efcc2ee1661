#include "common/result/stored.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"

namespace fathom::result {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kOldestSchema = 1, kSchema = 2;
constexpr std::array<const char*, 6> kVelocities{"u", "v", "w", "p", "q", "r"};

double real(const Json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

double real(const Json& object, const char* key) {
  return object.contains(key) ? real(object.at(key)) : std::numeric_limits<double>::quiet_NaN();
}

std::string text(const Json& object, const char* key) {
  return object.contains(key) && object.at(key).is_string() ? object.at(key).get<std::string>() : "";
}

std::vector<std::string> texts(const Json& object, const char* key) {
  return object.contains(key) ? object.at(key).get<std::vector<std::string>>() : std::vector<std::string>{};
}

const Json& list(const Json& object, const char* key) {
  static const Json kEmpty = Json::array();
  return object.contains(key) && !object.at(key).is_null() ? object.at(key) : kEmpty;
}

std::vector<NamedValue> numbers(const Json& object) {
  std::vector<NamedValue> values;
  for (const auto& [name, v] : object.items()) {
    NamedValue value{name, real(v, "value"), real(v, "std"), text(v, "unit"), std::nullopt};
    const Json& interval = list(v, "interval_95");
    if (interval.size() == 2) value.interval95 = {real(interval[0]), real(interval[1])};
    values.push_back(value);
  }
  return values;
}

std::array<double, 6> per_axis(const Json& object, const char* key) {
  std::array<double, 6> values{};
  for (std::size_t i = 0; i < 6; ++i)
    values[i] = object.contains(key) ? real(object.at(key), kVelocities[i]) : std::numeric_limits<double>::quiet_NaN();
  return values;
}

ModelError error(const Json& object) {
  ModelError error;
  for (const auto& [axis, rmse] : object.at("force_rmse").items()) error.force_rmse[axis] = real(rmse);
  for (const Json& p : object.at("prediction")) {
    error.prediction.push_back({real(p, "horizon_s"), per_axis(p, "rmse"), per_axis(p, "r2"), per_axis(p, "p_half"),
                                per_axis(p, "p_average")});
  }
  return error;
}

std::vector<AxisWhiteness> whiteness(const Json& object) {
  std::vector<AxisWhiteness> axes;
  for (const auto& [axis, w] : object.items()) {
    axes.push_back({.axis = axis,
                    .p_value = real(w, "p_value"),
                    .autocorrelation_time_s = real(w, "autocorrelation_time_s"),
                    .swing_period_s = real(w, "swing_period_s"),
                    .explained = real(w, "explained")});
  }
  return axes;
}

EffectFound effect(const Json& e) {
  EffectFound found{.name = text(e, "name"),
                    .variant = text(e, "variant"),
                    .accepted = e.at("accepted").get<bool>(),
                    .parameters = numbers(e.at("parameters")),
                    .log_odds = real(e, "log_odds"),
                    .sentence = text(e, "sentence")};
  found.probability = e.contains("probability") ? real(e, "probability") : 1.0 / (1.0 + std::exp(-found.log_odds));
  for (const Json& rival : list(e, "rivals"))
    found.alternatives.push_back({text(rival, "name"), real(rival, "log_odds")});
  for (const Json& told : list(e, "told_apart_by"))
    found.told_apart.push_back({text(told, "name"), text(told, "segment"), real(told, "seconds")});
  return found;
}

/// What a learned force says of itself; its terms stay in the file.
CorrectionGiven correction(const Json& c) {
  CorrectionGiven given;
  given.asked = true;
  given.adopted = c.value("adopted", false);
  given.refused = text(c, "refused");
  given.words = text(c, "words");
  given.log_odds = real(c, "log_odds");
  given.size = real(c, "size");
  return given;
}

void read_diagnosis(const Json& file, DiagnosisResult& result) {
  result.vehicle = text(file, "vehicle");
  result.train = texts(file, "train");
  result.validate = texts(file, "validate");
  result.verdict = file.at("verdict").get<std::string>();
  result.paragraph = text(file, "paragraph");
  if (file.contains("next")) result.manoeuvre = text(file.at("next"), "words");
  for (const Json& f : list(file, "consistency")) {
    result.consistency.push_back({text(f, "run"), text(f, "signal"), text(f, "reference"), text(f, "finding"),
                                  real(f, "size"), text(f, "unit"), text(f, "evidence"), text(f, "action")});
  }
  if (file.contains("correction")) result.correction = correction(file.at("correction"));
  for (const Json& e : file.at("effects")) result.effects.push_back(effect(e));
  for (const Json& s : list(file, "stand_ins"))
    result.stand_ins.push_back({text(s, "name"), text(s, "variant"), s.value("in_model", false), real(s, "size"),
                                real(s, "over"), real(s, "modulation"), numbers(s.at("parameters"))});
  for (const Json& c : file.at("candidates"))
    result.candidates.push_back({text(c, "name"), text(c, "variant"), real(c, "log_odds"), text(c, "reason")});
  for (const Json& g : list(file, "not_measured"))
    result.not_measured.push_back({text(g, "group"), texts(g, "cannot_be_asked"), text(g, "means")});
  result.error_before = error(file.at("error").at("before"));
  result.error_after = error(file.at("error").at("after"));
  const Json& gain = file.at("error").at("improvement");
  const Json& interval = gain.at("ci95");
  result.improvement = {real(gain, "value"), real(interval.at(0)), real(interval.at(1))};
  if (const auto far = file.at("error").find("foretold"); far != file.at("error").end())
    result.foretold = {far->value("windows", 0), far->value("cut", 0), real(*far, "typical_s")};
  result.parameters_before = numbers(file.at("parameters").at("before"));
  result.parameters_after = numbers(file.at("parameters").at("after"));
  if (file.contains("wiring"))
    result.wiring = WiringFault{texts(file.at("wiring"), "readings"), real(file.at("wiring"), "error_reduction")};
  result.residual_before = whiteness(file.at("residual").at("before"));
  result.residual_after = whiteness(file.at("residual").at("after"));
}

void read_given(const Json& file, VerdictGiven& given) {
  given.core = text(file, "core");
  for (const Json& c : list(file, "causes"))
    given.causes.push_back({text(c, "cause"), real(c, "value"), real(c, "threshold"), text(c, "of")});
  for (const Json& c : file.at("candidates")) {
    for (const Json& r : list(c, "refusals"))
      given.refusals[text(c, "name")].push_back({text(r, "rule"), real(r, "value"), real(r, "needed")});
  }
  if (!file.contains("covariance") || file.at("covariance").is_null()) return;
  given.covariance_of = texts(file.at("covariance"), "names");
  for (const Json& row : file.at("covariance").at("matrix")) {
    for (const Json& value : row) given.covariance.push_back(real(value));
  }
}

void read_origin(const Json& file, ResultOrigin& origin) {
  origin.command = text(file, "command");
  for (const Json& f : list(file, "files")) {
    OriginFile one;
    one.role = text(f, "role");
    one.run = text(f, "run");
    one.path = text(f, "path");
    one.sha256 = text(f, "sha256");
    one.bytes = f.at("bytes").get<std::uint64_t>();
    origin.files.push_back(std::move(one));
  }
}

}  // namespace

Stored read_result(const std::string& path) {
  const bool folder = std::filesystem::is_directory(path);
  Stored stored;
  stored.path = folder ? (std::filesystem::path{path} / "result.json").string() : path;
  std::ifstream text_of{stored.path};
  if (!text_of) throw InputError(stored.path + ": cannot be read; give the result.json that fathom diagnose wrote");
  const Json file = Json::parse(text_of, nullptr, false);
  if (file.is_discarded() || !file.is_object() || !file.contains("schema"))
    throw InputError(stored.path + ": is no result.json of fathom diagnose");
  if (file.value("kind", "diagnosis") != "diagnosis")
    throw InputError(stored.path + ": is the result of a " + file.value("kind", "") +
                     "; the diagnosis of its log stands in the folder diagnosis beside it");
  try {
    const int schema = file.at("schema").get<int>();
    if (schema < kOldestSchema || schema > kSchema)
      throw InputError(stored.path + ": has schema " + file.at("schema").dump() + ", and this version reads " +
                       std::to_string(kOldestSchema) + " to " + std::to_string(kSchema) +
                       "; take the version that wrote it (" + text(file, "fathom_version") + ")");
    stored.version = text(file, "fathom_version");
    if (file.contains("data")) {
      stored.begin = text(file.at("data"), "begin");
      stored.end = text(file.at("data"), "end");
    }
    read_diagnosis(file, stored.result);
    read_given(file, stored.given);
    read_origin(file, stored.origin);
  } catch (const Json::exception& wrong) {
    throw InputError(stored.path + ": is not as docs/schema/diagnosis-2.schema.json says: " + wrong.what());
  }
  return stored;
}

}  // namespace fathom::result
