//! Rows that are no part of the table: what an image costs without any, and what the panic gate must not let pass.

entries! {
    /// Nothing: its size, stack and time are the harness's own.
    control_empty 4 [] |run, R| {
        let value: (u32, Option<R>) = (run.bits(), None);
        let result = run.time_call(|| value);
        run.put_bits(u64::from(result.0));
    }
    /// An index that may be out of bounds.
    control_index 1 [] |run, R| {
        let values: [R; 3] = run.array(0.0, 1.0);
        let index = run.index(4);
        let result = run.time_call(|| values[index]);
        run.put(result);
    }
}
