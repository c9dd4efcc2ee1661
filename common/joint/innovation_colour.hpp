// How large and how lasting the innovations of one axis are, against what a filter states of them.
#pragma once

namespace fathom::joint {

/// Innovations of a right model are white: the square of their sum over a second is, on average, the sum of their
/// squares. What the model lacks goes on for longer and shows in the sums first; noise that is smaller or larger than
/// stated shows in the squares at once. By so much is the covariance of what was learnt from them to be multiplied.
class InnovationColour {
 public:
  /// One innovation of an inertial instrument in its standard deviations, 100 a second; 0, of one that was refused,
  /// tells nothing of those that were not.
  void hear(double score);
  /// Mean squared sum of a second over its length, of up to 40 seconds; beside them 20 as they would be if white. A
  /// tenth at least: instruments that tell nearly nothing of their noise do not make everything certain.
  [[nodiscard]] double ratio() const;

 private:
  double sum_{}, squares_{};  // within the present second
  int count_{}, seconds_{};
  double sums_{1.0}, white_{1.0};  // means over the last seconds
};

}  // namespace fathom::joint
