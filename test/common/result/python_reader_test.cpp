// contrib/fathom_result.py reads what the program writes.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "common/report/json.hpp"
#include "test/support/diagnosis_fixture.hpp"
#include "test/support/schema.hpp"

namespace fathom {

TEST_CASE("the Python reader gives the file's numbers as numpy has them") {
  if (!test::python_has("numpy")) return;
  const test::Scratch scratch;
  auto result = test::made_up_report({.samples = 0}).result;
  result.paragraph = "Thrust comes late.";
  const VerdictGiven given{
      .core = "", .causes = {}, .refusals = {}, .covariance_of = {"X_u", "m_X"}, .covariance = {4.0, -0.5, -0.5, 0.25}};
  test::write_bytes(scratch.path("result.json"), report::to_json(result, given));
  test::write_bytes(scratch.path("ask.py"), R"(
import json, sys
sys.path.insert(0, sys.argv[1])
import fathom_result
r = fathom_result.load(sys.argv[2])
names, P = r.covariance()
e = r.error("before", "rmse")
print(json.dumps({"verdict": r.verdict, "X_uu": r.parameters["X_u|u|"].value,
                  "late": r.effects["thruster_lag"]["time_constant"]._asdict(), "names": names, "P": P.tolist(),
                  "trace": float(P.trace()), "shape": list(e.shape), "yaw": e[1, 5], "horizons": r.horizons().tolist(),
                  "p_missing": bool(e[0, 3] != e[0, 3])}))
)");
  const std::string contrib = std::string{FATHOM_SOURCE_DIR} + "/contrib";
  const std::string python = "PYTHONDONTWRITEBYTECODE=1 " + test::kDebianPython + " ";
  const test::Ran ran =
      test::shell(python + scratch.path("ask.py") + " '" + contrib + "' " + scratch.path("result.json"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const auto said = nlohmann::json::parse(ran.text);
  CHECK(said["verdict"] == "effect");
  CHECK(said["X_uu"] == -12.4);
  CHECK(said["late"]["value"] == 0.352);
  CHECK(said["late"]["unit"] == "s");
  CHECK(said["names"] == nlohmann::json{"X_u", "m_X"});
  CHECK(said["trace"] == 4.25);
  CHECK(said["shape"] == nlohmann::json{3, 6});
  CHECK(said["yaw"] == result.error_before.prediction[1].rmse[5]);
  CHECK(said["horizons"] == nlohmann::json{1.0, 5.0, 10.0});
  CHECK(said["p_missing"] == true);

  const test::Ran told = test::shell(python + "'" + contrib + "/fathom_result.py' " + scratch.path("result.json"));
  CHECK(told.code == 0);
  CHECK(told.says("Thrust comes late."));
  CHECK(told.says("strongest correlation: -0.500 of X_u and m_X"));
  test::write_bytes(scratch.path("result.json"), R"({"schema": 3})");
  const test::Ran newer = test::shell(python + "'" + contrib + "/fathom_result.py' " + scratch.path("result.json"));
  CHECK(newer.code == 1);
  CHECK(newer.says("this reader knows 1 and 2"));
  CHECK(newer.lines() == 1);
}

}  // namespace fathom
