#pragma once

#include <string>
#include <string_view>

namespace conelane {

/// The text as a gzip file, without a name or a time: the same text gives the same bytes with one version of
/// zlib.
[[nodiscard]] std::string gzipped(std::string_view text);

}  // namespace conelane
