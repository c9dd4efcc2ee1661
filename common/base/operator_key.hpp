// The operator's key. The vehicle's processes and the operator's tool read the same small file; nothing of it travels.
#pragma once

#include <string>

#include "common/base/signing.hpp"

namespace fathom {

/// What orders, commands and answers are signed with: one key each, all derived from the file's. Who is given that of
/// commands alone can command what an operator has armed, and arm nothing.
struct OperatorKeys {
  Key order{}, command{}, answer{};
  bool known_to_all{false};  ///< the file says that everybody may read it: for simulations
};

[[nodiscard]] OperatorKeys keys_from(const Key& key);

/// `operator: {key: 64 hex digits}` of the file at `path`. InputError when there are fewer, or when others than the
/// owner may read the file and it does not say `known_to_all: yes`.
[[nodiscard]] OperatorKeys operator_keys(const std::string& path);

/// What an operator shall do who has no such file.
inline constexpr char kMakeKey[] =
    "(umask 077; printf 'operator: {key: %s}\\n' $(openssl rand -hex 32) > operator.yaml)";

}  // namespace fathom
