// Keeps what a decision was made from, so that it can be made again without the model.
//
// A folder holds decision.json and, for each hypothesis space, products_K.npy: the matrix
// [rᵀr (Aᵀr)ᵀ; Aᵀr AᵀA] of its whitened residual and columns.
#ifndef LACUNA_DIAGNOSIS_DECISION_STORE_H_
#define LACUNA_DIAGNOSIS_DECISION_STORE_H_

#include <filesystem>

#include "diagnosis/decision_input.h"

namespace lacuna {

// Replaces what the folder holds. Throws InputError if a file cannot be written.
void SaveDecisionInput(const DecisionInput& input, const std::filesystem::path& folder);
// Throws InputError, naming the file, if the folder does not hold a decision in this format.
DecisionInput LoadDecisionInput(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_DECISION_STORE_H_
