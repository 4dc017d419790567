/* Threads by pthreads; clocks and processors of Linux and macOS. */
#define _GNU_SOURCE
#include "platform/thread.h"
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

_Static_assert(sizeof(pthread_mutex_t) <= sizeof(brio_mutex), "a mutex has its room");
_Static_assert(sizeof(pthread_cond_t) <= sizeof(brio_condition), "a condition has its room");
_Static_assert(sizeof(pthread_t) <= sizeof((brio_thread *)0)->handle, "a thread has its room");

static pthread_mutex_t *mutex_of(brio_mutex *m) {
    return (pthread_mutex_t *)m->bytes;
}
static pthread_cond_t *condition_of(brio_condition *c) {
    return (pthread_cond_t *)c->bytes;
}

void brio_mutex_new(brio_mutex *m) {
    pthread_mutex_init(mutex_of(m), NULL);
}
void brio_mutex_free(brio_mutex *m) {
    pthread_mutex_destroy(mutex_of(m));
}
void brio_mutex_lock(brio_mutex *m) {
    pthread_mutex_lock(mutex_of(m));
}
void brio_mutex_unlock(brio_mutex *m) {
    pthread_mutex_unlock(mutex_of(m));
}

void brio_condition_new(brio_condition *c) {
    pthread_cond_init(condition_of(c), NULL);
}
void brio_condition_free(brio_condition *c) {
    pthread_cond_destroy(condition_of(c));
}
void brio_condition_wait(brio_condition *c, brio_mutex *m) {
    pthread_cond_wait(condition_of(c), mutex_of(m));
}
void brio_condition_wake_all(brio_condition *c) {
    pthread_cond_broadcast(condition_of(c));
}

/* --- threads --- */

static void *live(void *argument) {
    brio_thread *t = argument;
    t->work(t->argument);
    return NULL;
}

bool brio_thread_start(brio_thread *t, void (*work)(void *argument), void *argument, size_t stack) {
    static const int OWN[] = {SIGBUS, SIGSEGV, SIGFPE, SIGILL, SIGTRAP};
    pthread_attr_t attributes;
    sigset_t all, old;
    if (pthread_attr_init(&attributes)) return false;
    t->work = work;
    t->argument = argument;
    sigfillset(&all);
    for (size_t i = 0; i < sizeof OWN / sizeof *OWN; i++) sigdelset(&all, OWN[i]);
    pthread_attr_setstacksize(&attributes, stack);
    pthread_sigmask(SIG_SETMASK, &all, &old);
    bool created = pthread_create((pthread_t *)t->handle.bytes, &attributes, live, t) == 0;
    pthread_sigmask(SIG_SETMASK, &old, NULL);
    pthread_attr_destroy(&attributes);
    return created;
}

void brio_thread_join(brio_thread *t) {
    pthread_join(*(pthread_t *)t->handle.bytes, NULL);
}

int brio_processors(void) {
#ifdef __linux__
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0) return CPU_COUNT(&set);
#endif
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online > 0 && online < 1 << 16 ? (int)online : 1;
}

long brio_process_number(void) {
    return (long)getpid();
}

/* --- time --- */

void brio_yield(void) {
    sched_yield();
}

void brio_sleep(double seconds) {
    double whole = (double)(long)seconds;
    nanosleep(&(struct timespec){(time_t)whole, (long)(1e9 * (seconds - whole))}, NULL);
}

double brio_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
