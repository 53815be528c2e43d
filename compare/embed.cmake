# Writes a C file that holds another file's bytes and a zero: cmake -DINPUT=FILE -DOUTPUT=FILE.c
# -DSYMBOL=NAME -P embed.cmake. The assembler reads the bytes, which is quick for large files.
file(WRITE ${OUTPUT} "/* ${SYMBOL} */
__asm__(\".section .rodata\\n.global ${SYMBOL}\\n${SYMBOL}:\\n.incbin \\\"${INPUT}\\\"\\n.byte 0\\n.previous\\n\");
extern const char ${SYMBOL}[];
")
