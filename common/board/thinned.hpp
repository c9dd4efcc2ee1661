// The whole of something that goes on for hours, in a bounded number of points: when they are too many, every other one
// goes, and from then on half as many come.
#pragma once

#include <cstddef>
#include <vector>

namespace fathom::board {

template <class Value>
class Thinned {
 public:
  struct Point {
    double at{};  ///< s
    Value value{};
  };
  /// At most `most` points, at first not nearer than `spacing` [s].
  Thinned(std::size_t most, double spacing) : most_{most}, spacing_{spacing} {}

  /// Keeps it when it is time for another point; the newest one is always there. Where time falls all begins anew.
  void add(double now, const Value& value) {
    if (!points_.empty() && now < points_.back().at) points_.clear();
    if (points_.size() >= 2 && points_.back().at - points_[points_.size() - 2].at < spacing_) points_.pop_back();
    points_.push_back({now, value});
    if (points_.size() <= most_) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points_.size(); i += 2) points_[kept++] = points_[i];
    if (points_.size() % 2 == 0) points_[kept++] = points_.back();
    points_.resize(kept);
    spacing_ *= 2.0;
  }
  void clear() { points_.clear(); }
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }

 private:
  std::size_t most_;
  double spacing_;
  std::vector<Point> points_;
};

}  // namespace fathom::board
