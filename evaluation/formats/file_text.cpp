#include "evaluation/formats/file_text.hpp"

#include <array>
#include <cstdint>
#include <new>

#include <fmt/format.h>
#include <zlib.h>

namespace conelane {

namespace {

constexpr std::uint64_t kHashOfNothing = 14695981039346656037U;

std::uint64_t hash_with(std::uint64_t hash, std::string_view text) {
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
    return hash;
}

/// For deflateInit2: the largest window, with gzip's header and checksum.
constexpr int kGzipWindow = 15 + 16;
constexpr int kMemoryLevel = 8;
constexpr std::size_t kBlock = std::size_t{1} << 16U;

}  // namespace

std::string text_hash(std::string_view text) {
    return fmt::format("{:016x}", hash_with(kHashOfNothing, text));
}

std::string file_hash(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return "";
    std::uint64_t hash = kHashOfNothing;
    std::array<char, 1U << 16U> block{};
    while (stream.read(block.data(), block.size()), stream.gcount() > 0)
        hash = hash_with(hash, {block.data(), static_cast<std::size_t>(stream.gcount())});
    return fmt::format("{:016x}", hash);
}

std::string gzipped(std::string_view text) {
    z_stream stream{};
    if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzipWindow, kMemoryLevel,
                     Z_DEFAULT_STRATEGY) != Z_OK)
        throw std::bad_alloc();
    std::string packed;
    std::string block(kBlock, '\0');
    std::string input;
    int state = Z_OK;
    for (std::size_t taken = 0; state == Z_OK;) {
        if (stream.avail_in == 0) {
            input = text.substr(taken, kBlock);
            taken += input.size();
            // zlib's input pointer is not const, but zlib does not write to it.
            stream.next_in = reinterpret_cast<Bytef*>(input.data());
            stream.avail_in = static_cast<uInt>(input.size());
        }
        stream.next_out = reinterpret_cast<Bytef*>(block.data());
        stream.avail_out = static_cast<uInt>(block.size());
        state = deflate(&stream, taken == text.size() ? Z_FINISH : Z_NO_FLUSH);
        packed.append(block, 0, block.size() - stream.avail_out);
    }
    deflateEnd(&stream);
    if (state != Z_STREAM_END) throw std::runtime_error("zlib cannot pack a text");
    return packed;
}

}  // namespace conelane
