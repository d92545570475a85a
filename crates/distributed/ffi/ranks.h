/* METIS, and the little of MPI that `linear/distributed/ranks.rs` calls, in functions: the names of MPI are macros, which no binding can call. */
#include <metis.h>
#include <stdint.h>

/* Starts MPI, unless it runs: 0, or the level of threads that it gives where one call at a time is not among what it bears. */
int mpi_shim_start(void);
int mpi_shim_rank(void);
int mpi_shim_size(void);
/* MPI_COMM_WORLD as MUMPS, which is Fortran, wants it. */
int mpi_shim_world(void);
/* Hands `n` words from rank 0 to all. The others sleep in between, in the end for so many nanoseconds at a time. */
void mpi_shim_hand_out(int64_t *words, int n, long most);
/* Deals what rank 0 has: each rank gets its `n`, which are `counts` of them from `starts` on there. */
void mpi_shim_deal_numbers(const double *all, const int *counts, const int *starts, double *mine, int n);
void mpi_shim_deal_integers(const int32_t *all, const int *counts, const int *starts, int32_t *mine, int n);
/* The other way: collects the `n` numbers of each rank on rank 0, in their places. */
void mpi_shim_collect(const double *mine, int n, double *all, const int *counts, const int *starts);
/* Ends MPI, if it runs. */
void mpi_shim_end(void);
