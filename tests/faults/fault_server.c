/* A program that starts again and again: with BRIO_FAULT_SERVER=PLAN,ORDERS,ANSWERS in its environment it stops before main.
 * For each byte that comes through the descriptor ORDERS it forks; the child goes on to main with the plan in the mapped file
 * PLAN; its process and its status go to the descriptor ANSWERS, as two numbers of 32 bits. An end of orders is the end. */
#define _GNU_SOURCE
#include "fault.h"
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

static void begin_child(int plan) {
    void *shared = mmap(NULL, sizeof *fault, PROT_READ | PROT_WRITE, MAP_SHARED, plan, 0);
    if (shared == MAP_FAILED) _exit(99);
    int64_t kind = ((fault_plan *)shared)->kind;
    ((fault_plan *)shared)->kind = FAULT_NONE; /* until all is ready */
    fault = shared;
    bool seen = kind <= FAULT_THREAD || fault_see_calls();
    fault->live = 0;
    if (!seen) _exit(98);
    fault->kind = kind;
}

static void tell(int answers, int32_t number) {
    if (write(answers, &number, sizeof number) != sizeof number) _exit(97);
}

__attribute__((constructor)) static void serve(void) {
    const char *how = getenv("BRIO_FAULT_SERVER");
    int plan, orders, answers;
    char byte;
    if (!how || sscanf(how, "%d,%d,%d", &plan, &orders, &answers) != 3) return;
    while (read(orders, &byte, 1) == 1) {
        pid_t child = fork();
        if (child == 0) {
            begin_child(plan);
            close(plan), close(orders), close(answers);
            return;
        }
        int status = 0;
        tell(answers, child);
        waitpid(child, &status, 0);
        tell(answers, status);
    }
    _exit(0);
}
