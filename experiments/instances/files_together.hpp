#pragma once

#include "evaluation/formats/atomic_file.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace conelane::experiments {

/// Files that get their names together, once all of them are complete. Until then at most one is open.
class FilesTogether {
  public:
    void add(const std::filesystem::path& file, const std::string& content) {
        AtomicFile& output = *files_.emplace_back(std::make_unique<AtomicFile>(file));
        output.stream() << content;
        output.finish();
    }
    void commit() const {
        std::vector<AtomicFile*> all;
        for (const auto& file : files_) all.push_back(file.get());
        commit_together(all);
    }

  private:
    std::vector<std::unique_ptr<AtomicFile>> files_;
};

}  // namespace conelane::experiments
