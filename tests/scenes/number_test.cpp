#include "scenes/number.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <locale>
#include <sstream>

#include "scenes/names.h"

namespace penumbra {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Number, ReadsWholeTokens) {
  EXPECT_EQ(parse_number("1").value(), 1.0);
  EXPECT_EQ(parse_number(" -.5 ").value(), -0.5);
  EXPECT_EQ(parse_number("+2.").value(), 2.0);
  EXPECT_EQ(parse_number("-4.37114e-008").value(), -4.37114e-8);
  EXPECT_EQ(parse_number("1e-400").value(), 0.0);
  EXPECT_EQ(parse_number("0." + std::string(400, '0') + "1").value(), 0.0);
}

TEST(Number, RefusesTheRest) {
  for (const char* text :
       {"", " ", "one", "1x", "1 2", "1,5", "0x10", "--1", "+-1", "+", "-", ".", "1e", "1e5.5"}) {
    EXPECT_FALSE(parse_number(text)) << text;
  }
  for (const char* text : {"nan", "NaN", "inf", "-inf", "infinity", "1e400", "-1e400"}) {
    EXPECT_FALSE(parse_number(text)) << text;
  }
  EXPECT_THAT(parse_number("abc").error().message, HasSubstr("'abc' is not a number"));
  EXPECT_THAT(parse_number("nan").error().message, HasSubstr("not a finite number"));
  EXPECT_THAT(parse_number("1e400").error().message, HasSubstr("too large"));
  EXPECT_LT(parse_number(std::string(1000000, '\x01')).error().message.size(), 200u);
}

class DecimalComma : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(Number, DoesNotDependOnTheLocale) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  std::istringstream stream("1.5");
  double streamed = 0.0;
  stream >> streamed;
  EXPECT_NE(streamed, 1.5) << "the locale has no effect, so that this test shows nothing";
  EXPECT_EQ(parse_number("1.5").value(), 1.5);
  EXPECT_FALSE(parse_number("1,5"));
  EXPECT_EQ(parse_integer("1234").value(), 1234);
  std::locale::global(before);
}

TEST(Integer, ChecksItsRange) {
  EXPECT_EQ(parse_integer("-7").value(), -7);
  EXPECT_EQ(parse_integer("+7", 0, 10).value(), 7);
  for (const char* text : {"", "1.0", "1e3", "0x1", "seven", "99999999999999999999"})
    EXPECT_FALSE(parse_integer(text));
  EXPECT_THAT(parse_integer("11", 0, 10).error().message, HasSubstr("'11' is not in the range from 0 to 10"));
}

TEST(Boolean, TrueOrFalse) {
  EXPECT_TRUE(parse_boolean("True").value());
  EXPECT_FALSE(parse_boolean(" false ").value());
  for (const char* text : {"", "1", "yes", "truefalse"}) EXPECT_FALSE(parse_boolean(text).has_value());
}

TEST(List, SplitsAtSpacesAndCommas) {
  EXPECT_THAT(parse_numbers("1 2,3 , 4\n\t5").value(), ElementsAre(1, 2, 3, 4, 5));
  EXPECT_THAT(parse_numbers("").value(), IsEmpty());
  for (const char* text : {",1", "1,", "1,,2", "1 , ,2", ",", "1;2", "1 x"})
    EXPECT_FALSE(parse_numbers(text)) << text;
}

TEST(Names, OneSpelling) {
  EXPECT_EQ(to_snake_case("toWorld"), "to_world");
  EXPECT_EQ(to_snake_case("to_world"), "to_world");
  EXPECT_EQ(to_snake_case("intIOR"), "int_ior");
  EXPECT_EQ(to_snake_case("rrDepth"), "rr_depth");
  EXPECT_EQ(to_snake_case("cropOffsetX"), "crop_offset_x");
  EXPECT_EQ(to_snake_case("film.cropWidth"), "film.crop_width");
  EXPECT_EQ(to_snake_case("B"), "b");
  EXPECT_EQ(to_snake_case(""), "");
}

}  // namespace
}  // namespace penumbra
