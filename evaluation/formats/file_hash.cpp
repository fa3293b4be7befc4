#include "evaluation/formats/file_hash.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>

#include <fmt/format.h>

namespace conelane {

std::string file_hash(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return "";
    std::uint64_t hash = 14695981039346656037U;
    std::array<char, 1U << 16U> block{};
    while (stream.read(block.data(), block.size()), stream.gcount() > 0) {
        for (std::streamsize i = 0; i < stream.gcount(); ++i) {
            hash = (hash ^ static_cast<unsigned char>(block[static_cast<std::size_t>(i)])) * 1099511628211U;
        }
    }
    return fmt::format("{:016x}", hash);
}

}  // namespace conelane
