#pragma once

#include <filesystem>
#include <fstream>
#include <ostream>

namespace conelane {

/// Like std::ofstream, but keeps the reason of a failed write.
class OutputStream : public std::ostream {
  public:
    OutputStream() : std::ostream(nullptr) { rdbuf(&buffer_); }

    /// Fails like std::ofstream::open, with errno set.
    void open(const std::filesystem::path& file, std::ios::openmode mode);
    [[nodiscard]] bool is_open() const { return buffer_.is_open(); }
    void close();
    /// Throws InputError naming `file` if a write, a flush or the closing failed, with the system's reason.
    void require_written(const std::filesystem::path& file) const;

  private:
    class Buffer : public std::filebuf {
      public:
        [[nodiscard]] int reason() const { return reason_; }
        /// Runs a write, and keeps errno if it is the first failure.
        template <typename Write, typename Succeeded>
        auto watched(const Write& write, const Succeeded& succeeded);

      protected:
        int_type overflow(int_type character) override;
        std::streamsize xsputn(const char* text, std::streamsize count) override;
        int sync() override;

      private:
        int reason_ = 0;  ///< errno of the first failure; 0 without a failure
    };
    Buffer buffer_;
};

}  // namespace conelane
