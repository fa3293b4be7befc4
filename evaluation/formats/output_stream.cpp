#include "evaluation/formats/output_stream.hpp"

#include "evaluation/input_error.hpp"

#include <cerrno>
#include <string>
#include <system_error>

namespace conelane {

template <typename Write, typename Succeeded>
auto OutputStream::Buffer::watched(const Write& write, const Succeeded& succeeded) {
    errno = 0;
    const auto result = write();
    if (!succeeded(result) && reason_ == 0) reason_ = errno;
    return result;
}

std::filebuf::int_type OutputStream::Buffer::overflow(int_type character) {
    return watched([&] { return std::filebuf::overflow(character); },
                   [](int_type written) { return written != traits_type::eof(); });
}

std::streamsize OutputStream::Buffer::xsputn(const char* text, std::streamsize count) {
    return watched([&] { return std::filebuf::xsputn(text, count); },
                   [&](std::streamsize written) { return written == count; });
}

int OutputStream::Buffer::sync() {
    return watched([&] { return std::filebuf::sync(); }, [](int result) { return result == 0; });
}

void OutputStream::open(const std::filesystem::path& file, std::ios::openmode mode) {
    errno = 0;
    if (buffer_.open(file, mode | std::ios::out) == nullptr) {
        setstate(std::ios::failbit);
    } else {
        clear();
    }
}

void OutputStream::close() {
    const bool is_closed =
        buffer_.watched([&] { return buffer_.close() != nullptr; }, [](bool closed) { return closed; });
    if (!is_closed) setstate(std::ios::failbit);
}

void OutputStream::require_written(const std::filesystem::path& file) const {
    // `stream << other.rdbuf()` does not report a failed write of its target.
    if (good() && buffer_.reason() == 0) return;
    std::string message = "cannot be written to its end";
    if (buffer_.reason() != 0) message += ": " + std::generic_category().message(buffer_.reason());
    throw InputError(file, 0, "", message);
}

}  // namespace conelane
