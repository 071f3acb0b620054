/// Cells of a table's lines: where they begin and end, and whether they hold a number, nothing, or something else.
#pragma once
#include <string>
#include <string_view>

namespace rosin::app::scene {

/// Without blanks and tabs around it.
std::string_view trimmed(std::string_view text);
std::string lower(std::string_view text);
/// UTF-8 as it stands; else each byte above 127 as the letter that Latin-1 has there.
std::string in_utf8(std::string_view text);

/// A line without what ends it; blanks before it count where columns have fixed widths, and tabs where they separate.
std::string_view without_end(std::string_view line);
/// Text without the comment at its end.
std::string_view without_comment(std::string_view text);
bool is_comment(std::string_view text);

/// Takes the first cell off `rest`, whose data is null after the last; false when there is none. Quotes are taken off.
bool next_cell(std::string_view& rest, char separator, std::string_view& cell);

enum class Kind : char { number = 'N', missing = '-', text = 'T' };
/// A number with this decimal sign, all of the cell; a comma has a digit on each side. NaN where it is none.
Kind read_number(std::string_view cell, char decimal, double& value);
/// A time of day, "12:30:01.5", in s since midnight; behind a date, "2026-03-01T12:30:01.5", in s since 1970, where a
/// number holds 0.2 µs. NaN where it is none.
Kind read_clock(std::string_view cell, double& seconds);
/// One or the other.
Kind read_cell(std::string_view cell, char decimal, double& value);

}  // namespace rosin::app::scene
