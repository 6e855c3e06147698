#ifndef BOARD_H_
#define BOARD_H_

void print(const char *text);

#endif
