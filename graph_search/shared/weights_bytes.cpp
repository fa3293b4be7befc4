#include "graph_search/shared/weights_bytes.hpp"

#include "conelane/invalid_input.hpp"

#include <cstddef>
#include <fstream>

namespace conelane {

#ifdef __wasi__  // a WebAssembly module has no files: weights come as bytes
std::string weights_bytes(const std::filesystem::path& /*file*/) {
    throw InvalidInput("weights", "cannot be read");
}
#else
std::string weights_bytes(const std::filesystem::path& file) {
    constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;  // the shipped file has 0.13 MB
    std::ifstream stream(file, std::ios::binary);
    std::string bytes(1U << 16U, '\0');
    std::size_t size = 0;
    while (stream && size <= kMaxBytes) {
        if (size == bytes.size()) bytes.resize(2 * bytes.size());
        stream.read(bytes.data() + size, static_cast<std::streamsize>(bytes.size() - size));
        size += static_cast<std::size_t>(stream.gcount());
    }
    if (!stream.eof()) throw InvalidInput("weights", size > kMaxBytes ? "is too large" : "cannot be read");
    bytes.resize(size);
    return bytes;
}
#endif

void with_weights_file(const std::filesystem::path& file,
                       const std::function<void(std::string_view)>& parse) {
    try {
        parse(weights_bytes(file));
    } catch (const InvalidInput& error) {
        const std::string what = error.what();
        const std::string prefix = "weights: ";
        throw InvalidInput(
            "weights", file.string() + ": " + (what.starts_with(prefix) ? what.substr(prefix.size()) : what));
    }
}

}  // namespace conelane
