#include "common/driver/following.hpp"

#include <cmath>
#include <cstdio>

namespace fathom::driver {
namespace {

constexpr double kReports = 1.5;  // s without a report: nothing is known of what is applied

std::string newtons(double force) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f N", force);
  return text;
}

void since(std::optional<double>& when, bool is_so, double now) {
  if (!is_so) when.reset();
  if (is_so && !when) when = now;
}

}  // namespace

bool Following::reports(double now) const { return reported_at_ && now - *reported_at_ <= kReports; }

void Following::applied(const Eigen::VectorXd& force, double now) {
  latest_ = force;
  reported_at_ = now;
}

void Following::asked(const Eigen::VectorXd& force, double now) {
  const bool whole = reports(now) && latest_.size() == force.size();
  if (!whole || asked_.size() != force.size()) {  // from here on, and from rest
    asked_ = Eigen::VectorXd::Zero(force.size());
    applied_ = asked_;
    weak_since_.reset();
    unasked_since_.reset();
    step_at_ = now;
    return;
  }
  const double share = -std::expm1(-(now - step_at_.value_or(now)) / limits_.time_constant);
  step_at_ = now;
  asked_ += share * (force - asked_);
  applied_ += share * (latest_ - applied_);
  const double wanted = asked_.norm();
  const bool asks = wanted > limits_.least;
  const double along = asks ? applied_.dot(asked_) / wanted : 0.0;
  since(weak_since_, asks && along < limits_.least_share * wanted, now);
  since(unasked_since_, wanted < 0.2 * limits_.least && applied_.norm() > limits_.least, now);
  if (weak_since_ && now - *weak_since_ >= limits_.hold) {
    told_until_ = now + limits_.told;
    told_ = "the thrusters do not follow: of " + newtons(wanted) + " asked " + newtons(along) +
            " are applied; is the vehicle armed, in the right mode, and steered by nobody else?";
  } else if (unasked_since_ && now - *unasked_since_ >= limits_.hold) {
    told_until_ = now + limits_.told;
    told_ = "the thrusters run although nothing is asked: " + newtons(applied_.norm()) +
            "; stop whoever else steers the vehicle (a joystick, a ground station, its mode)";
  }
}

std::string Following::trouble(double now) const { return now <= told_until_ ? told_ : ""; }

}  // namespace fathom::driver
