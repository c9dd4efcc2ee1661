// XML of robots: elements, numbers and plugins, with the line in every complaint. tinyxml2 stays behind it.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/drafts/robot.hpp"

namespace tinyxml2 {  // NOLINT(readability-identifier-naming): theirs
class XMLElement;
class XMLDocument;
}  // namespace tinyxml2

namespace fathom::drafts {

/// An element; lives as long as its file. `none()` where there is no such child.
class Element {
 public:
  Element(const tinyxml2::XMLElement* element, const std::string* path) : element_{element}, path_{path} {}
  [[nodiscard]] bool none() const { return element_ == nullptr; }
  [[nodiscard]] std::string tag() const;
  [[nodiscard]] Element child(const char* tag) const;
  [[nodiscard]] std::vector<Element> children(const char* tag = nullptr) const;
  /// Itself excluded, in the order of the file.
  void each_below(const char* tag, const std::function<void(const Element&)>& visit) const;
  /// Without blanks around; empty when there is none.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::string text_of(const char* tag) const { return child(tag).text(); }
  [[nodiscard]] std::string attribute(const char* name) const;
  [[nodiscard]] bool has(const char* name) const;
  /// InputError when there are not `count` finite numbers.
  [[nodiscard]] std::vector<double> numbers(const std::string& from, std::size_t count) const;
  [[nodiscard]] double number(const std::string& from) const { return numbers(from, 1).front(); }
  [[noreturn]] void fail(const std::string& what) const;

 private:
  const tinyxml2::XMLElement* element_;
  const std::string* path_;
};

class XmlFile {
 public:
  /// InputError when it cannot be read, is no XML, is deeper than any robot, or holds xacro that was not run.
  explicit XmlFile(std::string path);
  ~XmlFile();
  XmlFile(const XmlFile&) = delete;
  XmlFile& operator=(const XmlFile&) = delete;
  [[nodiscard]] Element root() const;

 private:
  std::string path_;
  std::unique_ptr<tinyxml2::XMLDocument> document_;
};

/// Moments and products, text of elements or of attributes (URDF).
[[nodiscard]] Eigen::Matrix3d inertia_of(const Element& inertia, bool attributes);

/// Thruster plugins anywhere below: of gz-sim, UUV simulator and its successors. They name a joint, or the link it
/// moves.
void read_propellers(const Element& below, Robot& robot);

}  // namespace fathom::drafts
