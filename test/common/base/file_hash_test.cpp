#include "common/base/file_hash.hpp"

#include <doctest/doctest.h>

#include "common/base/error.hpp"
#include "test/support/scratch.hpp"

namespace fathom {

TEST_CASE("file hash: as the standard's examples have it (FIPS 180-4, 'abc'; a million of 'a')") {
  const test::Scratch scratch;
  test::write_bytes(scratch.path("abc"), "abc");
  const FileHash small = hash_of_file(scratch.path("abc"));
  CHECK(small.bytes == 3);
  CHECK(small.sha256 == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  test::write_bytes(scratch.path("many"), std::string(1'000'000, 'a'));
  const FileHash large = hash_of_file(scratch.path("many"));
  CHECK(large.bytes == 1'000'000);
  CHECK(large.sha256 == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  CHECK_THROWS_AS(static_cast<void>(hash_of_file(scratch.path("none"))), InputError);
}

}  // namespace fathom
