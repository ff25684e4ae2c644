#include "tools/pages/page.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "reference/error.h"
#include "tests/message_of.h"
#include "tests/temporary_folder.h"

namespace lodestone {
namespace {

using nlohmann::ordered_json;

// The page's own script, title and data, however odd these are: nothing of theirs ends a script or a tag.
TEST(Page, DataCannotEscapeItsScript) {
  ordered_json data;
  data["text"] = "</script><!-- & \" < > {{title}} {{data}}";
  const std::string page = make_page("view.html", "A <b>\"title\"</b> & more", data);
  EXPECT_EQ(page.find("A <b>"), std::string::npos);
  EXPECT_NE(page.find("A &lt;b>&quot;title&quot;&lt;/b> &amp; more"), std::string::npos);
  EXPECT_EQ(page.find("</script><!--"), std::string::npos);
  EXPECT_NE(page.find("\\u003c/script>\\u003c!--"), std::string::npos);
  EXPECT_NE(page.find("{{title}} {{data}}"), std::string::npos);  // as the data has it: no marker within
}

TEST(Page, NoMarkerOfItsOwnIsLeft) {
  const std::string page = make_page("view.html", "t", ordered_json::object());
  for (const char* marker : {"{{title", "{{data", "{{text:", "{{library:"})
    EXPECT_EQ(page.find(marker), std::string::npos) << marker;
}

TEST(Page, OneThatIsNotThereIsABug) {
  EXPECT_THROW(make_page("none.html", "t", ordered_json::object()), std::logic_error);
}

TEST(Page, IsSavedWholeOrNotAtAll) {
  const testing::TemporaryFolder folder;
  save_page(folder.at("deeper/page.html"), "one");
  save_page(folder.at("deeper/page.html"), "two");
  EXPECT_EQ(testing::bytes_of(folder.at("deeper/page.html")), "two");
  EXPECT_NE(testing::message_of([] { save_page("/dev/null/page.html", "x"); }), testing::kNothingThrown);
}

}  // namespace
}  // namespace lodestone
