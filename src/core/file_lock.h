// Locks on whole files among processes.
#ifndef LACUNA_CORE_FILE_LOCK_H_
#define LACUNA_CORE_FILE_LOCK_H_

namespace lacuna {

// Locks an open file, by its descriptor, against others that lock it (an open file description
// lock, fcntl(2)). The lock ends when the descriptor and its copies are closed, or with the
// process. Returns false, with the reason in errno, where there is no lock: EAGAIN or EACCES if
// another one holds it and `wait` is not set.
bool LockFile(int descriptor, bool wait);

// Whether another open file description holds the lock of this file.
bool IsLockedByAnother(int descriptor);

}  // namespace lacuna

#endif  // LACUNA_CORE_FILE_LOCK_H_
