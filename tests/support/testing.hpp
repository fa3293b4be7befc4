/// What nearly every test file includes. It is precompiled once for all of them (tests/CMakeLists.txt).
#pragma once

#include "tests/support/printers.hpp"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <ranges>
#include <set>
#include <span>
#include <sstream>
#include <utility>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace conelane {

using testing::AllOf;
using testing::Contains;
using testing::DoubleEq;
using testing::Each;
using testing::ElementsAre;
using testing::Ge;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Lt;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;
using testing::UnorderedElementsAre;

/// What `of`, a function or a member, gives for each element.
template <typename Range, typename Of>
auto mapped(const Range& range, const Of& of) {
    std::vector<std::decay_t<std::invoke_result_t<const Of&, std::ranges::range_reference_t<const Range&>>>>
        all;
    for (const auto& element : range) all.push_back(std::invoke(of, element));
    return all;
}

/// The name of a case of a parameterised test: a name may hold letters, digits and underscores.
inline std::string case_name(std::string_view words) {
    std::string name(words);
    std::ranges::replace(name, '-', '_');
    return name;
}

}  // namespace conelane
