#include "common/model/manoeuvring/manoeuvring_terms.hpp"

#include <cmath>

namespace fathom::model {

double manoeuvring_scale(const ManoeuvringTerm& term, const TermLengths& lengths) {
  switch (term.scale) {
    case TermScale::kPlain:
      return 1.0;
    case TermScale::kDraught:
      return 0.5 * lengths.density * std::pow(lengths.length, term.power - 1) * lengths.draught;
    case TermScale::kLength:
      break;
  }
  return 0.5 * lengths.density * std::pow(lengths.length, term.power);
}

Vector6d manoeuvring_wrench(std::span<const ManoeuvringCoefficient> coefficients, const TermMotion& motion,
                            const TermLengths& lengths) {
  Vector6d wrench = Vector6d::Zero();
  for (const ManoeuvringCoefficient& one : coefficients) {
    const double number = manoeuvring_scale(*one.term, lengths) * one.value;
    wrench[one.term->axis] += number * one.term->value(motion);
    if (one.term->other >= 0) wrench[one.term->other] += number * one.term->beside(motion);
  }
  return wrench;
}

}  // namespace fathom::model
