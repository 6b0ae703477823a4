// Makes the beginning of an experiment from an imported model: a mesh, a recording without data,
// and an experiment of `lacuna fit`.
#ifndef LACUNA_EXCHANGE_IMPORTED_EXPERIMENT_H_
#define LACUNA_EXCHANGE_IMPORTED_EXPERIMENT_H_

#include <filesystem>
#include <string>
#include <vector>

#include "exchange/inp_reader.h"

namespace lacuna {

// The units of an .inp file, which it does not state: with lengths in m those of SI; with lengths
// in mm the usual ones of mm, N, s: stresses in MPa, densities in tonne/mm³.
enum class InpUnits { kMetre, kMillimetre };

// The model with all numbers in SI units.
ImportedModel InSiUnits(ImportedModel model, InpUnits units);

// The material that the experiment gives to the whole body: the one that the sections of the file
// give to most tetrahedra; without sections the first one with an elasticity, or else the first
// one; null where the model has none. It belongs to `model`.
const ImportedMaterial* MaterialOfBody(const ImportedModel& model);

// Writes into `folder`, which is created,
//   NAME.msh            the mesh, in m
//   nodes_SET.txt       the numbers of the nodes of each node set, from 0, with the name of the set
//                       as an Identifier (unique_names.h)
//   recording.yaml      reference and the node sets; what has to be completed is marked TO DO
//   NAME.yaml           the experiment, with MaterialOfBody; marked TO DO where not
//                       all tetrahedra are known to have it, or its modulus is the instantaneous
//                       one
// and returns their names. `model` is in SI units, and `source` is the file that it was read from.
// Throws InputError where a file exists already, and for a name that an experiment cannot have: one
// that is no file name (IsFileName), or "recording".
std::vector<std::string> WriteImportedExperiment(const ImportedModel& model,
                                                 const std::string& name,
                                                 const std::filesystem::path& source,
                                                 const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_EXCHANGE_IMPORTED_EXPERIMENT_H_
