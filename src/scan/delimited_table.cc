#include "scan/delimited_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "core/error.h"
#include "scan/column_name.h"
#include "scan/table_layout.h"
#include "scan/table_numbers.h"
#include "scan/table_text.h"

namespace lacuna {
namespace {

// What begins the lines of the block above a table of DICe, the Digital Image Correlation Engine.
constexpr std::string_view kRemarkOfDice = "***";

// `entry` with one quote in the place of two.
std::string WithSingleQuotes(std::string_view entry) {
  std::string text;
  for (size_t at = 0; at < entry.size(); ++at) {
    text += entry[at];
    if (entry.substr(at, 2) == "\"\"") ++at;
  }
  return text;
}

std::string_view WithoutBrackets(std::string_view text) {
  const bool has_brackets = text.size() > 2 && ((text.front() == '(' && text.back() == ')') ||
                                                (text.front() == '[' && text.back() == ']'));
  return has_brackets ? Trim(text.substr(1, text.size() - 2)) : text;
}

// The names of columns that two lines give: in groups, and in them. Empty where the first line
// groups no columns, i.e. has neither a missing name nor the same name twice side by side.
std::vector<std::string> GroupedNames(const std::vector<std::string>& groups,
                                      const std::vector<std::string_view>& own) {
  std::vector<std::string> names;
  std::string group;
  bool has_groups = false;
  for (size_t k = 0; k < groups.size(); ++k) {
    const bool continues = k > 0 && (groups[k].empty() || groups[k] == groups[k - 1]);
    has_groups = has_groups || ((continues || groups[k].empty()) && !own[k].empty());
    if (!groups[k].empty()) group = groups[k];
    const std::string& own_group = own[k].empty() ? groups[k] : group;
    names.push_back(own_group + (own_group.empty() || own[k].empty() ? "" : "_") +
                    std::string(own[k]));
  }
  return has_groups ? names : std::vector<std::string>();
}

// Takes a line below the names that holds no number for the second line of the names of groups, or
// for the units, if one of its entries is a unit or in brackets. Returns whether it is one of
// these.
bool TakeSecondHeader(const std::vector<std::string_view>& fields, DelimitedTable* table) {
  if (table->header.empty() || !table->units.empty() || fields.size() != table->header.size() ||
      AreNumbers(fields))
    return false;
  int units = 0, words = 0;
  for (const std::string_view field : fields) {
    const std::optional<double> number = ParseDecimal(field);
    if (number && std::isfinite(*number)) return false;
    if (number) continue;
    ++(WithoutBrackets(field) != field || ParsedUnit(field) ? units : words);
  }
  if (words > 0) {
    const std::vector<std::string> names = GroupedNames(table->header, fields);
    if (!names.empty()) {
      table->header = names;
      return true;
    }
  }
  if (units == 0) return false;
  for (const std::string_view field : fields) table->units.emplace_back(WithoutBrackets(field));
  return true;
}

// Whether a text that is no number looks like a date or a time of day.
bool IsDate(std::string_view text) {
  const auto count = [text](char c) { return std::count(text.begin(), text.end(), c); };
  return !text.empty() && std::isdigit(static_cast<unsigned char>(text.front())) &&
         (count(':') > 0 || count('-') > 1 || count('/') > 1 || count('.') > 1);
}

// Whether a text is neither a number nor the beginning of one, as dates and numbers with separators
// of thousands are.
bool IsWord(std::string_view text) {
  const size_t at = text.find_first_not_of("+-., ");
  return !ParseDecimal(text) &&
         (at == std::string_view::npos || !std::isdigit(static_cast<unsigned char>(text[at])));
}

// Notes a header in which most entries are numbers with decimals: its line may be a row of data of
// which one entry cannot be read. Whole numbers are common names of channels.
void DoubtHeader(DelimitedTable* table, int line) {
  int numbers = 0, decimals = 0, words = 0;
  std::string word;
  for (const std::string& name : table->header) {
    const std::optional<double> value = ParseDecimal(name);
    if (!value) word = name;
    words += !value;
    numbers += value && std::isfinite(*value);
    decimals += value && std::isfinite(*value) && *value != std::floor(*value);
  }
  if (decimals == 0 || numbers <= words) return;
  table->notes.push_back(fmt::format(
      "{}:{}: the first line was taken for the names of the columns because of \"{}\", but {} of "
      "its {} entries are numbers",
      table->file.string(), line, word, numbers, table->header.size()));
}

// Notes a first row 0, 1, 2, … or 1, 2, 3, … above rows that are not whole numbers.
void DoubtFirstRow(DelimitedTable* table) {
  const Eigen::MatrixXd& values = table->values;
  if (!table->header.empty() || values.cols() < 3 || values.rows() < 3) return;
  const double first = values(0, 0);
  if (first != 0 && first != 1) return;
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    if (values(0, c) != first + static_cast<double>(c)) return;
  }
  const auto below = values.bottomRows(values.rows() - 1).array();
  if (((below - below.floor()) == 0).rowwise().all().any()) return;
  table->notes.push_back(fmt::format(
      "{}:{}: the first line, {:g}, {:g}, {:g}{}, was read as a row of data; if it numbers the "
      "columns, remove it or put a # in front",
      table->file.string(), table->line[0], first, first + 1, first + 2,
      values.cols() > 3 ? ", …" : ""));
}

// Reads a table line by line.
class TableReader {
 public:
  explicit TableReader(const std::filesystem::path& file) : content_(ReadFilledText(file)) {
    table_.file = file;
  }

  DelimitedTable Read() {
    while (at_ < content_.size()) {
      NextLine();
      if (SkipsLine()) continue;
      const std::vector<std::string_view> fields = SplitFields(line_, delimiter_);
      if (width_ == 0 && TakeHeader(fields)) continue;
      if (table_.line.empty() && TakeSecondHeader(fields, &table_)) continue;
      if (AreEmpty(fields))
        empty_rows_.push_back({line_number_, fields.size()});
      else
        TakeRow(fields);
    }
    if (table_.line.empty()) throw InputError({table_.file.string()}, "holds no row of numbers");
    commas_.RefuseThousands(table_.file, delimiter_);
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    table_.values = Eigen::Map<const RowMajor>(entries_.data(), table_.line.size(), width_);
    DoubtFirstRow(&table_);
    return std::move(table_);
  }

 private:
  void NextLine() {
    begin_ = at_;
    const size_t end = std::min(content_.find('\n', at_), content_.size());
    line_ = std::string_view(content_).substr(at_, end - at_);
    at_ = end + 1;
    ++line_number_;
  }

  // What follows the line.
  std::string_view Rest() const {
    return std::string_view(content_).substr(std::min(at_, content_.size()));
  }

  // Skips a line that holds neither names nor numbers of columns, and what belongs to it; finds the
  // delimiter before the first other line. Returns whether there was something to skip.
  bool SkipsLine() {
    if (const auto declared = DeclaredDelimiter(line_); declared && line_number_ == 1) {
      delimiter_ = *declared;
      return true;
    }
    const std::string_view text = Trim(line_);
    if (text.empty()) return true;
    if (text.front() == '#') {
      if (width_ == 0) TakeComment(text);
      return true;
    }
    if (width_ == 0 && text == kStageHeader) {
      at_ = std::min(content_.find('\n', at_), content_.size() - 1) + 1;  // and the line below
      ++line_number_;
      return true;
    }
    if (width_ == 0 && text.starts_with(kRemarkOfDice)) return true;
    if (table_.line.empty() && IsCount(text, Rest())) return true;
    if (delimiter_ != 0) return false;
    if (SkipsTitle()) return true;
    if (text.starts_with("//")) line_.remove_prefix(line_.find("//") + 2);
    delimiter_ = FindDelimiter(Trim(line_), Rest());
    return false;
  }

  void TakeComment(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of('#'), text.size()));
    comment_ = Trim(text);
    table_.comments.emplace_back(comment_);
  }

  bool SkipsTitle() {
    const std::string_view from = std::string_view(content_).substr(begin_);
    const size_t title = LengthOfTitle(from);
    if (title == 0) return false;
    at_ = begin_ + title;
    line_number_ += static_cast<int>(std::count(from.begin(), from.begin() + title, '\n')) - 1;
    return true;
  }

  // Takes the line for the names or, if it consists of numbers, only for the width of the table.
  // Returns whether it holds names.
  bool TakeHeader(const std::vector<std::string_view>& fields) {
    width_ = fields.size();
    if (!comment_.empty()) {
      const std::vector<std::string_view> names = SplitFields(comment_, delimiter_);
      if (names.size() == width_) table_.commented_header.assign(names.begin(), names.end());
    }
    if (AreNumbers(fields)) return false;
    std::transform(fields.begin(), fields.end(), std::back_inserter(table_.header),
                   WithSingleQuotes);
    DoubtHeader(&table_, line_number_);
    return true;
  }

  // Takes a row of numbers, and the empty rows above it.
  void TakeRow(const std::vector<std::string_view>& fields) {
    RefuseSummary(fields);
    for (const EmptyRow& empty : empty_rows_) {
      CheckWidth(empty.line, empty.width);
      entries_.insert(entries_.end(), width_, std::numeric_limits<double>::quiet_NaN());
      table_.line.push_back(empty.line);
    }
    empty_rows_.clear();
    CheckWidth(line_number_, fields.size());
    for (const std::string_view field : fields) {
      const int column = static_cast<int>(field.data() - line_.data()) + 1;
      const std::optional<double> value = ParseDecimal(field);
      if (!value)
        throw InputError({table_.file.string(), line_number_, column},
                         fmt::format("got \"{}\"; expected a number{}", field,
                                     IsDate(field) ? ", such as seconds since the first row: dates "
                                                     "and times of day are not read"
                                                   : ""));
      commas_.Add(field, line_number_, column);
      entries_.push_back(*value);
    }
    table_.line.push_back(line_number_);
  }

  // Refuses a line that begins with a word, such as "Mean,1.2,3.4", below the last row of numbers.
  void RefuseSummary(const std::vector<std::string_view>& fields) const {
    const auto first = std::find_if(fields.begin(), fields.end(),
                                    [](std::string_view field) { return !field.empty(); });
    if (table_.line.empty() || !IsWord(*first) || RowsFollow()) return;
    throw InputError(
        {table_.file.string(), line_number_, 1},
        fmt::format("is not a row of numbers (got \"{}\"); remove summary lines at the "
                    "end of the table, or put a # in front of them",
                    *first));
  }

  // Whether a row of numbers follows the current line.
  bool RowsFollow() const {
    for (const std::string_view line : SplitLines(Rest())) {
      const std::vector<std::string_view> fields = SplitFields(line, delimiter_);
      if (fields.size() == width_ && !AreEmpty(fields) && AreNumbers(fields)) return true;
    }
    return false;
  }

  void CheckWidth(int line, size_t entries) const {
    if (entries == width_) return;
    const bool may_be_decimal = delimiter_ == ',' && entries == 2 * width_;
    throw InputError(
        {table_.file.string(), line, 1},
        fmt::format("has {} entries where the first line has {}{}", entries, width_,
                    may_be_decimal ? "; decimal commas need another delimiter, such as ;" : ""));
  }

  struct EmptyRow {
    int line;
    size_t width;
  };

  const std::string content_;
  DelimitedTable table_;
  std::string_view line_;      // the current one
  size_t begin_ = 0, at_ = 0;  // where it begins in the content, and where the next one does
  int line_number_ = 0;
  char delimiter_ = 0;        // 0: not known yet
  size_t width_ = 0;          // entries of a row; 0: not known yet
  std::string_view comment_;  // the last above the first row
  std::vector<double> entries_;
  std::vector<EmptyRow> empty_rows_;  // those that no other row has followed so far
  DecimalCommas commas_;
};

}  // namespace

DelimitedTable ReadDelimitedTable(const std::filesystem::path& file) {
  return TableReader(file).Read();
}

}  // namespace lacuna
