#pragma once

#include "tests/support/testing.hpp"

#include <sys/mount.h>

namespace conelane {

/// A disk of its own that is soon full; it is removed with the test.
class SmallDisk {
  public:
    SmallDisk(std::filesystem::path folder, const std::string& size) : folder_(std::move(folder)) {
        std::filesystem::create_directories(folder_);
        mounted_ = ::mount("tmpfs", folder_.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
    }
    ~SmallDisk() {
        if (mounted_) ::umount2(folder_.c_str(), MNT_DETACH);
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;
    [[nodiscard]] bool is_mounted() const { return mounted_; }
    void grow(const std::string& size) const {
        ASSERT_EQ(::mount("tmpfs", folder_.c_str(), "tmpfs", MS_REMOUNT, ("size=" + size).c_str()), 0);
    }
    void make_read_only(bool read_only) const {
        ASSERT_EQ(
            ::mount("tmpfs", folder_.c_str(), "tmpfs", MS_REMOUNT | (read_only ? MS_RDONLY : 0), nullptr), 0);
    }

  private:
    std::filesystem::path folder_;
    bool mounted_ = false;
};

}  // namespace conelane
