#pragma once

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/provenance.hpp"

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

namespace conelane {

/// JSON Lines of figures that a command measured, each with commit, compiler and machine.
class FigureFile {
  public:
    /// Throws InputError naming the file if it cannot be written, here and in `commit`.
    explicit FigureFile(const std::filesystem::path& file) : output_(file), origin_(provenance()) {}

    void add(nlohmann::ordered_json figures);
    /// Gives the file its name; without this call there is no file.
    void commit() { output_.commit(); }

  private:
    AtomicFile output_;
    Provenance origin_;
};

}  // namespace conelane
