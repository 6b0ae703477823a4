// Long lists in messages.
#ifndef LACUNA_CORE_FIRST_FEW_H_
#define LACUNA_CORE_FIRST_FEW_H_

#include <string>
#include <vector>

namespace lacuna {

// "3, 5, 8, 9, … (12 in all)": at most the first four, separated by commas, and the number of all
// where there are more.
std::string FirstFew(const std::vector<std::string>& items);
std::string FirstFew(const std::vector<int>& numbers);

}  // namespace lacuna

#endif  // LACUNA_CORE_FIRST_FEW_H_
