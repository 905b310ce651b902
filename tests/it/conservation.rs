//! Conservation laws, exactness of the lengths, flat starts.
