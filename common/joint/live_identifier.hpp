// The identification of a trial: the recursive estimate alone, or the joint one beside it. Both hear everything; MODEL
// then carries the joint estimate's numbers, while adopted effects, the residual's tests and what is frozen stay with
// the recursive one. Where an effect was adopted, which the joint filter does not have, MODEL is the recursive one's.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "common/joint/joint_estimate.hpp"

namespace fathom::joint {

class LiveIdentifier {
 public:
  using Output = identification::Identifier::Output;

  /// Recursive alone. InputError as Identifier.
  LiveIdentifier(const identification::IdentifierSettings& settings, const model::Vehicle& vehicle);
  /// With the joint estimate beside it. InputError as Identifier and JointEstimate.
  LiveIdentifier(const identification::IdentifierSettings& settings, const model::Vehicle& vehicle,
                 const JointSettings& joint, const estimation::NavigatorSettings& navigator,
                 const estimation::NavigatorPlaces& places);
  LiveIdentifier(const LiveIdentifier&) = delete;
  LiveIdentifier& operator=(const LiveIdentifier&) = delete;
  ~LiveIdentifier() = default;

  /// The reference is good until the next call.
  const Output& step(const StateEstimate& state);
  /// `force` times the vehicle's allocation, else `tau`; a sample with neither is rejected.
  const Output& step(const Thrusters& thrusters);
  /// What the joint estimate rests on; without it nothing happens.
  template <class Sample>
  void hear(const Sample& sample) {
    if (joint_) joint_->hear(sample);
  }
  void hear(const Excitation& excitation);
  void hear(const EffectRanking& ranking) { recursive_.hear(ranking); }
  void hear(const Battery& battery) { recursive_.hear(battery); }
  /// The end of the input: models that waited for late measurements.
  const Output& finish();
  /// A log started over: back to the prior, nothing pending.
  void reset();

  [[nodiscard]] ModelEstimate model() const;
  [[nodiscard]] const identification::Identifier& recursive() const { return recursive_; }
  /// nullptr: there is none.
  [[nodiscard]] const JointEstimate* joint() const { return joint_.get(); }
  [[nodiscard]] std::string save_text() const;
  void offer(const std::string& text, double within);
  [[nodiscard]] bool resumed() const { return recursive_.resumed(); }
  [[nodiscard]] std::map<std::string, std::int64_t> rejected() const;

 private:
  struct Pending {
    ModelEstimate model;
    Residual residual;
    identification::RowBlock rows;
    ParameterMatrix bend;
  };
  void stash(const Output& output);
  void teach(const ModelEstimate& model);
  void say(const Pending& pending, bool reached);
  [[nodiscard]] ModelEstimate with_joint(ModelEstimate model, const ParameterMatrix& bend) const;
  [[nodiscard]] bool speaks(const ModelEstimate& model) const;
  void resume_joint();

  std::unique_ptr<const model::Vehicle> vehicle_;
  identification::Identifier recursive_;
  std::function<std::unique_ptr<JointEstimate>()> make_;
  std::unique_ptr<JointEstimate> joint_;
  std::deque<Pending> pending_;
  std::int64_t unreached_{};
  ParameterVector said_;  // numbers of the last MODEL
  std::string offered_;   // the joint estimate's part of a saved state
  Output output_;
};

}  // namespace fathom::joint
