/* The little of MPI that `ranks.rs` calls, in functions: the names of MPI are macros, which no binding can call. */

/* Starts MPI, unless it runs. Returns 0, or 1 + the level of threads if MPI does not allow calls from several threads, one at a time. */
int mpi_shim_start(void);
int mpi_shim_rank(void);
int mpi_shim_size(void);
/* Hands `n` bytes from rank 0 to all. The others sleep in between, in the end for so many nanoseconds at a time. */
void mpi_shim_hand_out(void *bytes, int n, long most);
/* Collects the `n` numbers of each rank on rank 0. */
void mpi_shim_collect(const double *mine, int n, double *all);
/* Ends MPI, if it runs. */
void mpi_shim_end(void);
