// Types read from their .lcm files: the same fingerprints as lcm-gen's, and messages decoded to what was encoded.
#include "common/exports/definitions.hpp"

#include <doctest/doctest.h>

#include <fathom_lcm/camera_t.hpp>
#include <fathom_lcm/vehicle_condition_t.hpp>

#include "common/exports/any_message.hpp"
#include "common/wire/streams.hpp"
#include "test/support/filled_samples.hpp"

namespace fathom {
namespace {

using exports::Definitions;

template <class Message>
std::vector<std::uint8_t> bytes_of(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  REQUIRE(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())) == static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace

TEST_CASE("definitions: every stream's fingerprint is that of the generated type") {
  const Definitions& all = Definitions::built_in();
  CHECK(all.all().size() > 30);
  int streams = 0;
  Recording recording;
  wire::visit_streams(recording, [&](const char*, auto& stream) {
    using Sample = typename std::remove_reference_t<decltype(stream)>::value_type;
    using Message = wire::MessageOf<Sample>;
    const exports::Type& type = all.type("fathom_lcm", Message::getTypeName());
    CAPTURE(type.name);
    CHECK(all.fingerprint(type) == static_cast<std::uint64_t>(Message::getHash()));
    ++streams;
  });
  CHECK(streams == 26);
  CHECK(all.fingerprint(all.type("fathom_lcm", "camera_t")) ==
        static_cast<std::uint64_t>(fathom_lcm::camera_t::getHash()));
  CHECK(all.fingerprint(all.type("fathom_lcm", "vehicle_condition_t")) ==
        static_cast<std::uint64_t>(fathom_lcm::vehicle_condition_t::getHash()));
}

TEST_CASE("definitions: a comment stays with its field") {
  const exports::Type& state = Definitions::built_in().type("fathom_lcm", "state_t");
  REQUIRE(state.fields.size() == 8);
  CHECK(state.comment.starts_with("Channel STATE"));
  CHECK(state.fields[1].name == "p_WB");
  CHECK(state.fields[1].sizes == std::vector<std::string>{"3"});
  CHECK(state.fields[1].comment == "[m] Bo from Wo, in W (NED)");
}

TEST_CASE("any message: numbers, words, lists and nested types arrive") {
  test::Fill fill;
  ModelEstimate model;
  test::fill(fill, model);
  const auto bytes = bytes_of(wire::encode(model));
  const Definitions& all = Definitions::built_in();
  const exports::Type* type = all.type_of(bytes);
  REQUIRE(type != nullptr);
  CHECK(type->name == "model_t");
  const auto message = exports::decoded(all, *type, bytes);
  REQUIRE(message);
  CHECK(message->at("utime") == model.utime);
  REQUIRE(message->at("parameters").size() == 2);
  CHECK(message->at("parameters")[1].at("name") == model.parameters[1].name);
  CHECK(message->at("parameters")[1].at("value") == model.parameters[1].value);
  CHECK(message->at("effects")[2] == model.effects[2]);
  CHECK(message->at("covariance") == nlohmann::ordered_json(model.covariance));
  CHECK(message->at("joint") == true);

  for (std::size_t cut = 8; cut < bytes.size(); cut += 7)
    CHECK_FALSE(exports::decoded(all, *type, std::span{bytes}.first(cut)));
  auto longer = bytes;
  longer.push_back(0);
  CHECK_FALSE(exports::decoded(all, *type, longer));
  auto wild = bytes;
  wild[16] = 0x7f;  // the number of parameters: two thousand million
  CHECK_FALSE(exports::decoded(all, *type, wild));
}

TEST_CASE("any message: bytes as base64 (RFC 4648), or counted") {
  const auto text = [](const std::string& word) {
    return exports::base64({reinterpret_cast<const std::uint8_t*>(word.data()), word.size()});
  };
  CHECK(text("") == "");
  CHECK(text("f") == "Zg==");
  CHECK(text("fo") == "Zm8=");
  CHECK(text("foobar") == "Zm9vYmFy");
  fathom_lcm::camera_t camera;
  camera.n_jpeg = 3;
  camera.jpeg = {'f', 'o', 'o'};
  const auto bytes = bytes_of(camera);
  const Definitions& all = Definitions::built_in();
  CHECK(exports::decoded(all, *all.type_of(bytes), bytes)->at("jpeg") == "Zm9v");
  CHECK(exports::decoded(all, *all.type_of(bytes), bytes, exports::Bytes::kCount)->at("jpeg") == 3);
}

TEST_CASE("any message: the JSON Schema has every field with its comment") {
  const Definitions& all = Definitions::built_in();
  const auto schema = exports::json_schema(all, all.type("fathom_lcm", "effects_t"));
  CHECK(schema.at("title") == "fathom_lcm.effects_t");
  const auto& candidates = schema.at("properties").at("candidates");
  CHECK(candidates.at("type") == "array");
  CHECK(candidates.at("items").at("properties").at("numbers").at("items").at("type") == "number");
  CHECK(schema.at("properties").at("duration").at("description") == "[s] of it, again and again");
}

}  // namespace fathom
