#pragma once

/// Files of apps/workflow, which the program contains.

#include <string_view>

namespace hardbody {

std::string_view workflow_snakefile();      ///< rules that run the tasks of a plan
std::string_view workflow_local_profile();  ///< options of Snakemake for the processors of this machine
std::string_view workflow_slurm_profile();  ///< options of Snakemake for Slurm

}  // namespace hardbody
