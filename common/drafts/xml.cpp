#include "common/drafts/xml.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/printable.hpp"

namespace fathom::drafts {
namespace {

constexpr std::uintmax_t kMostBytes = 64U << 20U;  // a robot's description is a hundred times smaller

std::string trimmed(const char* text) {
  if (text == nullptr) return {};
  std::string all{text};
  const auto begin = all.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) return {};
  return all.substr(begin, all.find_last_not_of(" \t\r\n") - begin + 1);
}

bool names_thruster(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  // A manager of thrusters makes no thrust itself.
  return text.find("thruster") != std::string::npos && text.find("manager") == std::string::npos &&
         text.find("alloc") == std::string::npos;
}

// Visits the names of an element and of all below.
template <class Visit>
void each_element(const tinyxml2::XMLElement* element, const Visit& visit) {
  visit(element->Name());
  for (const auto* each = element->FirstChildElement(); each != nullptr; each = each->NextSiblingElement()) {
    each_element(each, visit);
  }
}

std::string first_of(const Element& element, std::initializer_list<const char*> tags) {
  for (const char* tag : tags) {
    std::string text = element.text_of(tag);
    if (!text.empty()) return text;
  }
  return {};
}

}  // namespace

std::string Element::tag() const { return element_ != nullptr ? element_->Name() : ""; }

Element Element::child(const char* tag) const {
  return {element_ != nullptr ? element_->FirstChildElement(tag) : nullptr, path_};
}

std::vector<Element> Element::children(const char* tag) const {
  std::vector<Element> all;
  if (element_ == nullptr) return all;
  for (const auto* each = element_->FirstChildElement(tag); each != nullptr; each = each->NextSiblingElement(tag)) {
    all.emplace_back(each, path_);
  }
  return all;
}

// The reader bounds the depth of a file.
void Element::each_below(const char* tag, const std::function<void(const Element&)>& visit) const {
  for (const Element& each : children()) {
    if (each.tag() == tag) visit(each);
    each.each_below(tag, visit);
  }
}

std::string Element::text() const { return element_ != nullptr ? trimmed(element_->GetText()) : ""; }

std::string Element::attribute(const char* name) const {
  return element_ != nullptr ? trimmed(element_->Attribute(name)) : "";
}

bool Element::has(const char* name) const { return element_ != nullptr && element_->Attribute(name) != nullptr; }

void Element::fail(const std::string& what) const {
  throw InputError(*path_ + ":" + std::to_string(element_ != nullptr ? element_->GetLineNum() : 0) + ": " +
                   printable(what));
}

std::vector<double> Element::numbers(const std::string& from, std::size_t count) const {
  std::vector<double> all;
  std::istringstream words{from};
  for (std::string word; words >> word;) {
    double value = 0.0;
    const char* begin = word.data() + (word[0] == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) {
      fail("'" + word + "' in <" + tag() + "> is no number");
    }
    all.push_back(value);
  }
  if (all.size() != count) {
    fail("<" + tag() + "> needs " + std::to_string(count) + (count == 1 ? " number, not " : " numbers, not ") +
         std::to_string(all.size()));
  }
  return all;
}

XmlFile::XmlFile(std::string path) : path_{std::move(path)}, document_{std::make_unique<tinyxml2::XMLDocument>()} {
  std::ifstream file{path_, std::ios::binary};
  if (!file) throw InputError(path_ + ": cannot be read");
  std::string text;
  std::array<char, 65536> piece{};
  while (file.read(piece.data(), piece.size()) || file.gcount() > 0) {
    text.append(piece.data(), static_cast<std::size_t>(file.gcount()));
    if (text.size() > kMostBytes) throw InputError(path_ + ": too large for the description of a robot");
  }
  if (document_->Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS || document_->RootElement() == nullptr) {
    throw InputError(path_ + ":" + std::to_string(std::max(1, document_->ErrorLineNum())) + ": is no XML (" +
                     document_->ErrorName() + ")");
  }
  bool xacro = false;
  each_element(document_->RootElement(),
               [&](const char* name) { xacro = xacro || std::string_view{name}.starts_with("xacro:"); });
  if (xacro) throw InputError(path_ + ": holds xacro; run it first: xacro FILE > robot.urdf");
}

XmlFile::~XmlFile() = default;

Element XmlFile::root() const { return {document_->RootElement(), &path_}; }

Eigen::Matrix3d inertia_of(const Element& inertia, bool attributes) {
  const auto value = [&](const char* name) {
    const std::string text = attributes ? inertia.attribute(name) : inertia.text_of(name);
    return text.empty() ? 0.0 : inertia.number(text);
  };
  // All are read before the matrix is filled: an exception halfway through a comma initialiser ends the program.
  const double xx = value("ixx"), yy = value("iyy"), zz = value("izz"), xy = value("ixy"), xz = value("ixz"),
               yz = value("iyz");
  Eigen::Matrix3d I;
  I << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return I;
}

void read_propellers(const Element& below, Robot& robot) {
  below.each_below("plugin", [&](const Element& plugin) {
    if (!names_thruster(plugin.attribute("filename")) && !names_thruster(plugin.attribute("name"))) return;
    Propeller propeller{.joint = first_of(plugin, {"joint_name", "jointName"}), .number = {}, .largest = {}};
    const std::string link = first_of(plugin, {"link_name", "linkName"});
    for (const Joint& joint : robot.joints) {
      if (propeller.joint.empty() && !link.empty() && joint.child == link) propeller.joint = joint.name;
    }
    if (propeller.joint.empty()) plugin.fail("this thruster names neither its joint nor a link that a joint moves");
    if (const std::string number = plugin.text_of("thrusterID"); !number.empty()) {
      propeller.number = static_cast<int>(std::clamp(plugin.number(number), 0.0, 1e6));
    }
    if (const std::string largest = first_of(plugin, {"max_thrust_cmd", "thrustMax"}); !largest.empty()) {
      if (const double force = plugin.number(largest); force > 0.0) propeller.largest = force;
    }
    if (const std::string density = plugin.text_of("fluid_density"); !density.empty()) {
      if (const double value = plugin.number(density); value > 0.0) robot.water_density = value;
    }
    robot.propellers.push_back(propeller);
  });
}

}  // namespace fathom::drafts
