// result.json against docs/schema by python3-jsonschema. Beyond what the schema asks of others, what Fathom writes must
// be described: no key that the schema does not name.
#pragma once

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom::test {

inline const std::string kDebianPython = "/usr/bin/python3";

/// Whether Debian's Python has a module; says what is skipped where not.
inline bool python_has(const std::string& module) {
  if (shell(kDebianPython + " -c 'import " + module + "'").code == 0) return true;
  MESSAGE("skipped: Debian's python3-" << module << " is not installed (scripts/packages-python.txt)");
  return false;
}

/// The schema without freedom for keys that it does not name.
inline void close(nlohmann::json& schema) {
  if (schema.is_object() && schema.contains("properties") && !schema.contains("additionalProperties"))
    schema["additionalProperties"] = false;
  for (auto& part : schema) {
    if (part.is_structured()) close(part);
  }
}

/// What the validator objects to in the file; empty when nothing, and where there is no validator.
inline std::string against_schema(const Scratch& scratch, const std::string& result, const std::string& schema) {
  if (!python_has("jsonschema")) return "";
  const std::string path = std::string{FATHOM_SOURCE_DIR} + "/docs/schema/" + schema + ".schema.json";
  nlohmann::json closed = nlohmann::json::parse(read_bytes(path));
  close(closed);
  write_bytes(scratch.path("closed.schema.json"), closed.dump());
  const Ran ran = shell(kDebianPython + " -W ignore -m jsonschema -i '" + result + "' '" +
                        scratch.path("closed.schema.json") + "'");
  return ran.code == 0 ? "" : "not as " + schema + ".schema.json says:\n" + ran.text;
}

}  // namespace fathom::test
