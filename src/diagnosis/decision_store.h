// Keeps what a decision was made from, so that it can be made again without the model.
//
// A folder holds decision.json and, for each hypothesis space, the matrix
// [rᵀr (Aᵀr)ᵀ; Aᵀr AᵀA] of its whitened residual and columns in products_HASH.npy. HASH is the hash
// of the numbers of the matrix, by which decision.json names it, so that a matrix can neither be
// taken for that of another decision nor change unnoticed.
#ifndef LACUNA_DIAGNOSIS_DECISION_STORE_H_
#define LACUNA_DIAGNOSIS_DECISION_STORE_H_

#include <filesystem>

#include "diagnosis/decision_input.h"

namespace lacuna {

// Replaces what the folder holds. If it is interrupted, the folder holds the decision before.
// Throws InputError if a file cannot be written.
void WriteDecisionInput(const DecisionInput& input, const std::filesystem::path& folder);
// Throws InputError, naming the file, if the folder does not hold a decision in this format, or if
// a matrix is missing or has changed.
DecisionInput ReadDecisionInput(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_DECISION_STORE_H_
