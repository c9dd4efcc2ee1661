// Which candidates earn a full fit: those that promise most, less those that did not keep their promises.
#include "common/diagnosis/questions.hpp"

#include <doctest/doctest.h>

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

const model::Effect* const kLag = model::find_effect("thruster_lag");
const model::Effect* const kPayload = model::find_effect("payload_change");
const model::Effect* const kGain = model::find_effect("thruster_gain");

/// One candidate per (effect, form, promised share).
struct Asked {
  const model::Effect* effect;
  int variant;
  double share;
};

Answers answers(const std::vector<Asked>& asked) {
  Answers all;
  for (const Asked& each : asked) {
    Screened screened;
    screened.effect = each.effect;
    screened.variant = each.variant;
    all.near.push_back(screened);
    all.share.push_back(each.share);
    Judged judged;
    judged.effect = each.effect;
    judged.variant = each.variant;
    all.judged.push_back(judged);
    all.fitted.push_back(false);
    all.found.emplace_back();
  }
  return all;
}

using Order = std::vector<std::size_t>;
const Settings kSettings;

}  // namespace

TEST_CASE("questions: the best form of each effect is fitted, those that promise most first") {
  const Answers asked = answers({{kLag, 0, 0.2}, {kGain, 0, 0.3}, {kGain, 1, 0.5}, {kPayload, 0, 0.0}});
  CHECK(worth_fitting(asked, {}, kSettings, Which::kAll) == Order{2, 0});
}

TEST_CASE("questions: what has been fitted, and what something speaks against, waits") {
  Answers asked = answers({{kLag, 0, 0.2}, {kGain, 0, 0.3}, {kPayload, 0, 0.4}});
  asked.fitted[2] = true;
  asked.judged[1].reason = "odds too small";
  CHECK(worth_fitting(asked, {}, kSettings, Which::kOpen) == Order{0});
  CHECK(worth_fitting(asked, {}, kSettings, Which::kAll) == Order{1, 0});
}

TEST_CASE("questions: a form that a look from afar has found is fitted, however little the screening promises") {
  Answers asked = answers({{kLag, 0, 0.2}, {kPayload, 0, 0.0}});
  asked.found[1] = model::Model{};
  CHECK(worth_fitting(asked, {}, kSettings, Which::kFromAfar) == Order{1});
  CHECK(worth_fitting(asked, {}, kSettings, Which::kAll).size() == 2);
}

TEST_CASE("questions: who did not keep a promise is asked later") {
  const Answers asked = answers({{kLag, 0, 0.2}, {kPayload, 0, 0.6}});
  Promises promises;
  CHECK(worth_fitting(asked, promises, kSettings, Which::kAll) == Order{1, 0});
  promises.kept(asked, 1, 0.03);
  CHECK(promises.expected(asked, 1) == doctest::Approx(0.03));
  CHECK(worth_fitting(asked, promises, kSettings, Which::kAll) == Order{0, 1});
}

TEST_CASE("questions: a form refused twice keeps its refusal until it promises clearly more") {
  Answers asked = answers({{kPayload, 0, 0.4}, {kLag, 0, 0.2}});
  asked.judged[0].reason = "carries over to no other block";
  Promises promises;
  promises.refused(asked, 0);
  Answers next = answers({{kPayload, 0, 0.4}, {kLag, 0, 0.2}});
  promises.recall(next);
  CHECK_FALSE(next.fitted[0]);  // once may have been the company
  promises.refused(asked, 0);
  promises.recall(next);
  CHECK(next.fitted[0]);
  CHECK(next.judged[0].reason == asked.judged[0].reason);
  CHECK_FALSE(next.fitted[1]);
  Answers stronger = answers({{kPayload, 0, 0.8}});
  promises.recall(stronger);
  CHECK_FALSE(stronger.fitted[0]);
}

TEST_CASE("questions: what no fit has judged says so") {
  Answers asked = answers({{kLag, 0, 0.2}, {kGain, 0, 0.1}, {kPayload, 0, 0.1}});
  asked.fitted[0] = true;
  asked.judged[1].reason = "cannot be seen";
  name_unfitted(asked);
  CHECK(asked.judged[0].reason.empty());
  CHECK(asked.judged[1].reason == "cannot be seen");
  CHECK_FALSE(asked.judged[2].reason.empty());
}
