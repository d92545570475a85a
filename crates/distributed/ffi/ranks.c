/* The names of MPI are macros, which no binding can call. */
#include <mpi.h>
#include <stdlib.h>
#include <time.h>
#include "ranks.h"

int mpi_shim_start(void) {
    int runs = 0, level = MPI_THREAD_MULTIPLE;
    MPI_Initialized(&runs);
    if (runs)
        MPI_Query_thread(&level);
    else {
        /* Without a launcher Open MPI would start a process to wait for others to be started. */
        setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
        MPI_Init_thread(NULL, NULL, MPI_THREAD_SERIALIZED, &level);
    }
    return level >= MPI_THREAD_SERIALIZED ? 0 : 1 + level;
}

int mpi_shim_rank(void) {
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    return rank;
}

int mpi_shim_size(void) {
    int size = 1;
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    return size;
}

void mpi_shim_hand_out(void *bytes, int n, long most) {
    /* The same call on every rank: MPI does not match a broadcast that waits with one that does not. */
    MPI_Request request;
    struct timespec pause = {0, 20000};
    int done = 0, rank = mpi_shim_rank();
    MPI_Ibcast(bytes, n, MPI_BYTE, 0, MPI_COMM_WORLD, &request);
    if (rank == 0)
        MPI_Wait(&request, MPI_STATUS_IGNORE);
    else
        for (MPI_Test(&request, &done, MPI_STATUS_IGNORE); !done; MPI_Test(&request, &done, MPI_STATUS_IGNORE)) {
            /* Who has waited for long can be late by a tenth of that. */
            nanosleep(&pause, NULL);
            if (pause.tv_nsec < most)
                pause.tv_nsec += pause.tv_nsec / 10;
        }
}

void mpi_shim_collect(const double *mine, int n, double *all) {
    MPI_Gather(mine, n, MPI_DOUBLE, all, n, MPI_DOUBLE, 0, MPI_COMM_WORLD);
}

void mpi_shim_end(void) {
    int runs = 0, ended = 0;
    MPI_Initialized(&runs);
    MPI_Finalized(&ended);
    if (runs && !ended)
        MPI_Finalize();
}
