#pragma once

#include <stdexcept>
#include <string>

namespace conelane {

/// An invalid value in a scene, a parameter set or an option. `what()` is "KEY: REASON"; readers of files add
/// file and line.
class InvalidInput : public std::invalid_argument {
  public:
    InvalidInput(const std::string& key, const std::string& reason)
        : std::invalid_argument(key + ": " + reason), key_(key) {}

    /// The key as the file formats spell it, such as "cones[3].x", or the name of an option.
    [[nodiscard]] const std::string& key() const { return key_; }

  private:
    std::string key_;
};

}  // namespace conelane
