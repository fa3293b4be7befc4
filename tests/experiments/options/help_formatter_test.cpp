#include "experiments/options/command_line.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

TEST(HelpFormatter, TextIsBrokenAtSpacesAndAWordThatIsTooLongBehindAMark) {
    EXPECT_THAT(wrapped("", 5), ElementsAre(""));
    EXPECT_THAT(wrapped("one two", 7), ElementsAre("one two"));
    EXPECT_THAT(wrapped("one two", 6), ElementsAre("one", "two"));
    EXPECT_THAT(wrapped("one two three", 7), ElementsAre("one two", "three"));
    EXPECT_THAT(wrapped("one\n\ntwo", 9), ElementsAre("one", "", "two"));
    EXPECT_THAT(wrapped("aa,bb,cc dd", 6), ElementsAre("aa,bb,", "cc dd"));
    EXPECT_THAT(wrapped("abcdefgh", 3), ElementsAre("abc", "def", "gh"));
}

TEST(HelpFormatter, NothingOfALongNameOrDescriptionIsLost) {
    CLI::App app("what it does", "program");
    app.formatter(std::make_shared<HelpFormatter>());
    std::string names;
    std::string text;
    for (int i = 0; i < 40; ++i) {
        names += (i == 0 ? "" : ",") + ("method" + std::to_string(i));
        text += (i == 0 ? "" : " ") + ("word" + std::to_string(i));
    }
    std::string value;
    app.add_option("--short", value, "said beside it");
    app.add_option("--methods", value, text)->option_text("=[" + names + "]");
    app.add_subcommand("below", text);
    const std::string help = app.help();
    EXPECT_THAT(help, HasSubstr("  --short TEXT                said beside it\n"));
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), kHelpColumns) << line;
    const auto joined = [](const std::string& broken) {
        std::istringstream words(broken);
        std::string all;
        for (std::string word; words >> word;) all += word + ' ';
        return all;
    };
    const std::string said = joined(help);
    const std::size_t first = said.find(text);
    ASSERT_NE(first, std::string::npos) << help;
    EXPECT_NE(said.find(text, first + 1), std::string::npos) << "of the option and of the command";
    for (int i = 0; i < 40; ++i) EXPECT_THAT(help, HasSubstr("method" + std::to_string(i)));
}

}  // namespace
}  // namespace conelane::experiments
