#include "evaluation/formats/folder_lock.hpp"

#include "evaluation/input_error.hpp"

#include <cerrno>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace conelane {

FolderLock::FolderLock(const std::filesystem::path& folder)
    : descriptor_(::open((folder / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) {
        throw InputError(folder, 0, "", "cannot be written: " + std::generic_category().message(errno));
    }
    while (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EINTR) continue;
        const int reason = errno;
        ::close(descriptor_);
        throw InputError(folder, 0, "",
                         reason == EWOULDBLOCK
                             ? "another conelane is writing there"
                             : "cannot be locked: " + std::generic_category().message(reason));
    }
}

FolderLock::~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace conelane
