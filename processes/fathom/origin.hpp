// The origin of a result: hashes of the files, dates of the data, the command as a shell takes it.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "common/samples/recording.hpp"
#include "common/samples/result_origin.hpp"

namespace fathom::tool {

/// Adds a file that is no recording; nothing where `path` is empty.
void add_file(ResultOrigin& origin, std::string_view role, const std::string& path);

/// Adds the file, or the files of a split recording, of a run; `stretches`: what was read of it, all or in stretches.
void add_recording(ResultOrigin& origin, std::string_view role, const std::string& path,
                   std::span<const Recording> stretches);

/// Appends an option and its words to the command, quoted where a shell needs it; nothing where `words` is empty.
void add_words(ResultOrigin& origin, std::string_view option, std::span<const std::string> words);
void add_words(ResultOrigin& origin, std::string_view option, const std::string& word);

}  // namespace fathom::tool
