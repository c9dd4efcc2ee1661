#include "common/base/units.hpp"

#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <string>

#include "common/base/error.hpp"

namespace fathom {
namespace {

// Exponents of metre, kilogram, second, ampere, kelvin, degree Celsius (no offset is ever applied, so it stays apart
// from kelvin) and radian.
enum Base : std::size_t { kMetre, kKilogram, kSecond, kAmpere, kKelvin, kCelsius, kRadian, kBases };

struct Unit {
  double factor{1.0};
  std::array<int, kBases> power{};
};

struct Symbol {
  std::string_view name;
  Unit unit;
};

constexpr double kPi = std::numbers::pi;
constexpr std::array<Symbol, 49> kSymbols{{
    {"m", {1.0, {1}}},
    {"mm", {1e-3, {1}}},
    {"cm", {1e-2, {1}}},
    {"km", {1e3, {1}}},
    {"ft", {0.3048, {1}}},
    {"in", {0.0254, {1}}},
    {"cc", {1e-6, {3}}},
    {"L", {1e-3, {3}}},
    {"kn", {1852.0 / 3600.0, {1, 0, -1}}},
    {"kg", {1.0, {0, 1}}},
    {"g", {1e-3, {0, 1}}},
    {"s", {1.0, {0, 0, 1}}},
    {"ms", {1e-3, {0, 0, 1}}},
    {"us", {1e-6, {0, 0, 1}}},
    {"ns", {1e-9, {0, 0, 1}}},
    {"min", {60.0, {0, 0, 1}}},
    {"h", {3600.0, {0, 0, 1}}},
    {"N", {1.0, {1, 1, -2}}},
    {"kN", {1e3, {1, 1, -2}}},
    {"Nm", {1.0, {2, 1, -2}}},
    {"J", {1.0, {2, 1, -2}}},
    {"Pa", {1.0, {-1, 1, -2}}},
    {"kPa", {1e3, {-1, 1, -2}}},
    {"MPa", {1e6, {-1, 1, -2}}},
    {"mbar", {1e2, {-1, 1, -2}}},
    {"hPa", {1e2, {-1, 1, -2}}},
    {"dbar", {1e4, {-1, 1, -2}}},
    {"bar", {1e5, {-1, 1, -2}}},
    {"V", {1.0, {2, 1, -3, -1}}},
    {"mV", {1e-3, {2, 1, -3, -1}}},
    {"A", {1.0, {0, 0, 0, 1}}},
    {"mA", {1e-3, {0, 0, 0, 1}}},
    {"W", {1.0, {2, 1, -3}}},
    {"kW", {1e3, {2, 1, -3}}},
    {"Hz", {1.0, {0, 0, -1}}},
    {"kHz", {1e3, {0, 0, -1}}},
    {"K", {1.0, {0, 0, 0, 0, 1}}},
    {"C", {1.0, {0, 0, 0, 0, 0, 1}}},
    {"rad", {1.0, {0, 0, 0, 0, 0, 0, 1}}},
    {"mrad", {1e-3, {0, 0, 0, 0, 0, 0, 1}}},
    {"deg", {kPi / 180.0, {0, 0, 0, 0, 0, 0, 1}}},
    {"rpm", {2.0 * kPi / 60.0, {0, 0, -1, 0, 0, 0, 1}}},
    {"rps", {2.0 * kPi, {0, 0, -1, 0, 0, 0, 1}}},
    {"rev", {2.0 * kPi, {0, 0, 0, 0, 0, 0, 1}}},
    {"G", {9.80665, {1, 0, -2}}},  // of accelerometers; gauss has no use here
    {"mG", {9.80665e-3, {1, 0, -2}}},
    {"%", {1e-2, {}}},
    {"-", {1.0, {}}},
    {"1", {1.0, {}}},
}};

void multiply(Unit& left, const Unit& right, int exponent) {
  left.factor *= std::pow(right.factor, exponent);
  for (std::size_t i = 0; i < kBases; ++i) left.power[i] += exponent * right.power[i];
}

// Grammar: product = power { ["*" | "/"] power }, left to right; power = atom ["^" integer]; atom = symbol | "("
// product ")".
class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  Unit parse() {
    skip();
    if (at_ == text_.size()) return {};
    const Unit unit = product();
    if (at_ != text_.size()) fail("unexpected '" + std::string(1, text_[at_]) + "'");
    return unit;
  }

 private:
  static constexpr int kMaxDepth = 16;     // far beyond any unit; keeps hostile text from exhausting the stack
  static constexpr int kMaxExponent = 12;  // beyond any physical power

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError("unit '" + std::string(text_) + "': " + what);
  }
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  [[nodiscard]] char next() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  Unit product() {
    if (++depth_ > kMaxDepth) fail("too many parentheses");
    Unit unit = power();
    for (skip(); next() != '\0' && next() != ')'; skip()) {
      const char sign = next();
      if (sign == '*' || sign == '/') ++at_;
      multiply(unit, power(), sign == '/' ? -1 : 1);
    }
    --depth_;
    return unit;
  }

  Unit power() {
    Unit base = atom();
    skip();
    if (next() != '^') return base;
    ++at_;
    skip();
    const std::size_t begin = at_;
    if (next() == '-' || next() == '+') ++at_;
    while (std::isdigit(static_cast<unsigned char>(next())) != 0) ++at_;
    const int exponent = std::atoi(std::string(text_.substr(begin, at_ - begin)).c_str());
    if (exponent == 0 || std::abs(exponent) > kMaxExponent) fail("'^' needs a small whole number other than 0");
    Unit unit;
    multiply(unit, base, exponent);
    return unit;
  }

  Unit atom() {
    skip();
    if (next() == '(') {
      ++at_;
      const Unit unit = product();
      if (next() != ')') fail("missing ')'");
      ++at_;
      return unit;
    }
    const std::size_t begin = at_;
    if (next() == '1' || next() == '%' || next() == '-') {
      ++at_;
    } else {
      while (std::isalpha(static_cast<unsigned char>(next())) != 0) ++at_;
    }
    const std::string_view name = text_.substr(begin, at_ - begin);
    for (const Symbol& symbol : kSymbols) {
      if (symbol.name == name) return symbol.unit;
    }
    fail(name.empty() ? "a symbol is missing" : "'" + std::string(name) + "' is not a known unit");
  }

  std::string_view text_;
  std::size_t at_{0};
  int depth_{0};
};

// An angle, an angular rate or an angular acceleration: only there the radian is more than the number one.
bool is_angular(const Unit& unit) {
  return unit.power[kRadian] == 1 && unit.power[kMetre] == 0 && unit.power[kKilogram] == 0 &&
         unit.power[kAmpere] == 0 && unit.power[kKelvin] == 0 && unit.power[kCelsius] == 0;
}

}  // namespace

double unit_factor(std::string_view from, std::string_view to) {
  Unit given = Parser(from).parse();
  Unit wanted = Parser(to).parse();
  if (!is_angular(wanted)) given.power[kRadian] = wanted.power[kRadian] = 0;
  if (given.power != wanted.power) {
    throw InputError((from.empty() ? "the unit is missing" : "unit '" + std::string(from) + "' does not fit") +
                     (to.empty() ? ": a plain number is expected" : ": expected '" + std::string(to) + "'"));
  }
  return given.factor / wanted.factor;
}

}  // namespace fathom
